// Requests to the scanner about the other poses of a scan's object.

import {json, sending} from './api.js';

/**
 * @typedef {Object} Registration  of a pose; where it is not accepted, `reason` alone
 * @property {boolean} accepted
 * @property {string} reason
 * @property {number} [overlap]  share of what the pose shows that was seen before
 * @property {number} [residual_mm]
 * @property {boolean} [symmetric]
 * @property {number[][]} [object_from_platform]  4 x 4, metres
 * @property {number} [contradiction]  0 to 2: share of what the pose saw where nothing is as was seen before, and the other way round
 * @property {Candidate[]} [candidates]  other poses that were found to fit, the best first
 * @property {number | null} [candidate]  which of them was refined; null: pairs of points
 *
 * @typedef {{object_from_platform: number[][], overlap: number, residual_mm: number, contradiction: number}} Candidate
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

/**
 * Some of what was seen before, in the object's frame, and of what this pose saw, in the frame of its platform.
 * @param {string} scan @param {number} pose @returns {Promise<{before_mm: number[][], pose_mm: number[][]}>}
 */
export const posePoints = (scan, pose) => json(`${path(scan)}/${pose}/points`);

/** @param {string} scan @param {number} pose @param {Object} choice @returns {Promise<import('./api_builds.js').Build>} the model of all poses to come */
export const choosePose = (scan, pose, choice) => json(`${path(scan)}/${pose}`, sending('POST', choice));
