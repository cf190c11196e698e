// Requests about the sensor's pose. API.md describes the responses.

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
 * @typedef {Object} TurnReport  the pose solved from the stops of a turn
 * @property {boolean} accepted
 * @property {string} reason  of a refusal
 * @property {number | null} shift_mm
 * @property {number | null} tilt_deg
 * @property {number | null} sigma_mm
 * @property {number | null} sigma_deg
 * @property {number | null} before_mm
 * @property {number | null} after_mm
 * @property {{angle_deg: number, off_deg: number}[]} stops
 * @property {{code: string, detail: string, hint: string, stop?: number, parameters?: import('../base/wording.js').Parameters}[]} findings
 * @property {{before: number[][], after: number[][]}} [slice_mm]
 * @property {boolean} [confirms_told]  of a rig with lasers
 *
 * @typedef {{fx: number, fy: number, cx: number, cy: number, k1: number, k2: number}} Lens
 *
 * @typedef {Object} LensReport  a camera's lens solved from a printed board
 * @property {boolean} accepted
 * @property {string} reason
 * @property {Lens | null} lens
 * @property {Lens | null} sigma
 * @property {number | null} rms_px
 * @property {number} views
 * @property {(Optics & {sigma: Optics}) | null} [optics]  of a Kinect
 *
 * @typedef {{advice: 'show' | 'hold-still' | 'tilt' | 'reach' | 'turn', corners: number[][], coverage: number[]}} BoardLook
 *
 * @typedef {{accepted: boolean, reason: string, rms_before: number | null, rms_after: number | null, walls: {distance_m: number}[]}} WallReport
 *
 * @typedef {Object} CalibrationRun
 * @property {'turn' | 'wall' | 'lens'} kind
 * @property {'running' | 'done' | 'refused' | 'failed' | 'cancelled'} state
 * @property {'turning' | 'solving' | 'looking'} phase
 * @property {number} stop
 * @property {number} stops
 * @property {TurnReport | WallReport | LensReport | null} report  by `kind`
 * @property {BoardLook | null} look  in a run for a lens, the current view of the board
 * @property {{code: string, detail: string, hint: string} | null} error
 *
 * @typedef {{fx: number, fy: number, cx: number, cy: number, k1: number, k2: number, depth_scale: number, depth_offset_per_m: number}} Optics
 * @typedef {Optics & {sigma: Optics, source: 'turn' | 'scan' | 'board', at: string}} OpticsRecord
 *
 * @typedef {PoseRecord & {
 *   shift_mm: number | null, tilt_deg: number | null,
 *   sensor_map: {serial: string, at: string, on_for_s: number | null, rms_before: number, rms_after: number} | null,
 *   sensor_on_s: number | null,
 *   infrared: boolean,
 *   optics: (OpticsRecord & {history: OpticsRecord[]}) | null,
 *   lens: {told: Lens, kept: (Lens & {serial: string, at: string, rms_px: number}) | null} | null,
 *   history: PoseRecord[], run: CalibrationRun | null}} Calibration
 *
 * @typedef {{sensor: import('../sensor/overlay.js').Sensor, points_mm: import('../base/pose.js').Point[]}} Points  in the optical frame
 */

/** @returns {Promise<Points>} every eighth reading of the last frame, in rows and columns */
export const points = () => json('preview/points');

/** @returns {Promise<Calibration>} */
export const calibration = () => json('calibration');

const maxAge = 3000;  // milliseconds

/** @type {{response: Promise<Calibration>, at: number} | null} */
let recent = null;

/** For those who look from time to time: they share a response that is a few seconds old. */
export function recentCalibration() {
  if (!recent || performance.now() - recent.at > maxAge) {
    const response = calibration();
    recent = {response, at: performance.now()};
    response.catch(() => {
      recent = null;
    });
  }
  return recent.response;
}

/** A change, after which no response from before it is shared. @template T @param {Promise<T>} request */
const changing = (request) => request.finally(() => {
  recent = null;
});

/** @param {{kind: 'turn', stops: number} | {kind: 'wall', frames: number} | {kind: 'lens', square_mm?: number}} what */
export const measure = (what) => changing(json('calibration', sending('POST', what)));

/** @returns {Promise<import('../sensor/map_picture.js').MapPicture>} */
export const sensorMap = () => json('calibration/sensor-map');

export const cancel = () => changing(json('calibration/cancel', sending('POST')));

/** Restores the pose before the one in force. */
export const undo = () => changing(json('calibration/undo', sending('POST')));

/** @param {{platform_from_sensor?: number[][] | null, scale?: number, sensor_map?: null, optics?: null, lens?: 'keep' | 'discard' | null}} wanted */
export const change = (wanted) => changing(json('calibration', sending('PATCH', wanted)));

/** Whether a pose was found with this rig: by a turn, a scan, or on the page. @param {PoseRecord} pose */
export const isCalibrated = ({source}) => source === 'turn' || source === 'scan' || source === 'page';
