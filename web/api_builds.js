// Requests to the scanner about the models that are built from a stored scan.

import {json, sending, withoutAnswer} from './api.js';

/** @typedef {import('./api.js').Settings} Settings */

/**
 * @typedef {Object} Build
 * @property {string} scan  its id
 * @property {number} build  its number; 0 is what the scan itself made
 * @property {'waiting' | 'running' | 'finished' | 'failed' | 'cancelled'} state
 * @property {'starting' | 'calibrating' | 'registering' | 'rebuilding' | 'building' | 'done'} phase
 * @property {string} created
 * @property {number} snapshots_done
 * @property {number} snapshots_total
 * @property {Partial<Settings> & {leaf_size_mm: number, method: Settings['method'], calibrate: Settings['calibrate']}} settings
 * @property {{code: string, detail: string, hint: string} | null} error
 * @property {import('./api.js').ScanCalibration | null} calibration
 * @property {import('./api.js').Model | null} model
 * @property {string[]} [poses]  scans of other poses that are in it
 * @property {{id: string, detail: string} | null} [cluster_job]  of a build that is made elsewhere
 * @property {boolean} chosen  it is the scan's model
 */

const path = (/** @type {string} */ scan) => `scans/${encodeURIComponent(scan)}/builds`;

/** @param {string} scan @returns {Promise<Build[]>} what the scan made first */
export const builds = async (scan) => (await json(path(scan))).builds;

/** @param {string} scan @param {Object} settings  those that are to differ; `choose` makes it the scan's model @returns {Promise<Build>} */
export const build = (scan, settings) => json(path(scan), sending('POST', settings));

/** @param {string} scan @param {number} number @returns {Promise<Build>} */
export const cancelBuild = (scan, number) => json(`${path(scan)}/${number}/cancel`, sending('POST'));

/** @param {string} scan @param {number} number @returns {Promise<import('./api.js').Scan>} */
export const chooseBuild = (scan, number) => json(`${path(scan)}/${number}/choose`, sending('POST'));

/** @param {string} scan @param {number} number */
export const removeBuild = (scan, number) => withoutAnswer(`${path(scan)}/${number}`, 'DELETE');
