// Requests about the sensor's pose. What the scanner answers is described in API.md.

import {json, sending} from './api.js';

/**
 * @typedef {Object} PoseRecord  a pose that is or was in force
 * @property {number[][]} platform_from_sensor
 * @property {'default' | 'settings' | 'page' | 'turn' | 'scan'} source
 * @property {string | null} at
 * @property {number | null} sigma_mm
 * @property {number | null} sigma_deg
 * @property {number | null} before_mm
 * @property {number | null} after_mm
 * @property {number} scale
 *
 * @typedef {Object} TurnReport  what the stops of a turn tell of the pose
 * @property {boolean} accepted
 * @property {string} reason  why not
 * @property {number | null} shift_mm
 * @property {number | null} tilt_deg
 * @property {number | null} sigma_mm
 * @property {number | null} sigma_deg
 * @property {number | null} before_mm
 * @property {number | null} after_mm
 * @property {{angle_deg: number, off_deg: number}[]} stops
 * @property {{code: string, detail: string, hint: string, stop?: number}[]} findings
 * @property {{before: number[][], after: number[][]}} [slice_mm]
 *
 * @typedef {Object} CalibrationRun
 * @property {'running' | 'done' | 'refused' | 'failed' | 'cancelled'} state
 * @property {'turning' | 'solving'} phase
 * @property {number} stop
 * @property {number} stops
 * @property {TurnReport | null} report
 * @property {{code: string, detail: string, hint: string} | null} error
 *
 * @typedef {PoseRecord & {
 *   shift_mm: number | null, tilt_deg: number | null,
 *   history: PoseRecord[], run: CalibrationRun | null}} Calibration
 *
 * @typedef {{sensor: import('./overlay.js').Sensor, points_mm: import('./pose.js').Point[]}} Points  in the optical frame
 */

/** @returns {Promise<Points>} every eighth reading of the last frame, both ways */
export const points = () => json('preview/points');

/** @returns {Promise<Calibration>} */
export const calibration = () => json('calibration');

/** Begins a turn. @param {number} stops */
export const measureTurn = (stops) => json('calibration', sending('POST', {kind: 'turn', stops}));

export const cancel = () => json('calibration/cancel', sending('POST'));

/** Brings back the pose before the one in force. */
export const undo = () => json('calibration/undo', sending('POST'));

/** @param {{platform_from_sensor?: number[][] | null, scale?: number}} wanted */
export const change = (wanted) => json('calibration', sending('PATCH', wanted));
