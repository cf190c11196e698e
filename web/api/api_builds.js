// Requests about the models built from a stored scan.

import {json, sending, withoutAnswer} from './api.js';

/** @typedef {import('./api.js').Settings} Settings */

/**
 * @typedef {Object} Build
 * @property {string} scan  its id
 * @property {number} build  its number; 0: made by the scan itself
 * @property {'waiting' | 'running' | 'finished' | 'failed' | 'cancelled'} state
 * @property {'starting' | 'calibrating' | 'registering' | 'rebuilding' | 'building' | 'done'} phase
 * @property {string} created
 * @property {number} snapshots_done
 * @property {number} snapshots_total
 * @property {Partial<Settings> & import('../scan/edits.js').Edits & {leaf_size_mm: number, method: Settings['method'], calibrate: Settings['calibrate']}} settings
 * @property {{code: string, detail: string, hint: string} | null} error
 * @property {import('./api.js').ScanCalibration | null} calibration
 * @property {import('./api.js').Model | null} model
 * @property {string[]} [poses]  scans of further poses in it
 * @property {{id: string, detail: string} | null} [cluster_job]  of a build on a cluster
 * @property {boolean} chosen  whether it is the scan's model
 */

const path = (/** @type {string} */ scan) => `scans/${encodeURIComponent(scan)}/builds`;

/** @param {string} scan @returns {Promise<Build[]>} the scan's own first */
export const builds = async (scan) => (await json(path(scan))).builds;

/** @param {string} scan @param {Object} settings  that differ from the scan's; `choose` makes the build the scan's model @returns {Promise<Build>} */
export const build = (scan, settings) => json(path(scan), sending('POST', settings));

/** @param {string} scan @param {number} number @returns {Promise<Build>} */
export const cancelBuild = (scan, number) => json(`${path(scan)}/${number}/cancel`, sending('POST'));

/** @param {string} scan @param {number} number @returns {Promise<import('./api.js').Scan>} */
export const chooseBuild = (scan, number) => json(`${path(scan)}/${number}/choose`, sending('POST'));

/** @param {string} scan @param {number} number */
export const removeBuild = (scan, number) => withoutAnswer(`${path(scan)}/${number}`, 'DELETE');
