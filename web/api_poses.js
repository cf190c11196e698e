// Requests to the scanner about the other poses of a scan's object.

import {json, sending} from './api.js';

/**
 * @typedef {Object} Registration  of a pose; where it is not accepted, `reason` alone
 * @property {boolean} accepted
 * @property {string} reason
 * @property {number} [overlap]  share of what the pose shows that was seen before
 * @property {number} [residual_mm]
 * @property {boolean} [symmetric]
 *
 * @typedef {Object} Pose
 * @property {number} pose  from 1
 * @property {string} scan  id of the scan that was made of it
 * @property {import('./api.js').Scan['state']} state
 * @property {Registration | null} registration
 */

const path = (/** @type {string} */ scan) => `scans/${encodeURIComponent(scan)}/poses`;

/** @param {string} scan @returns {Promise<import('./api.js').Scan>} the scan of the object as it lies now */
export const startPose = (scan) => json(path(scan), sending('POST'));

/** @param {string} scan @param {number} pose @returns {Promise<import('./api.js').Scan>} as it was before that pose */
export const removePose = (scan, pose) => json(`${path(scan)}/${pose}`, sending('DELETE'));
