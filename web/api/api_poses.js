// Requests about further poses of a scan's object.

import {json, sending} from './api.js';

/**
 * @typedef {Object} Registration  of a pose; only `reason` if it is not accepted
 * @property {boolean} accepted
 * @property {string} reason
 * @property {number} [overlap]  share of the pose's surface that was seen before
 * @property {number} [residual_mm]
 * @property {boolean} [symmetric]
 * @property {number[][]} [object_from_platform]  4 x 4, metres
 * @property {number} [contradiction]  0 to 2: the share of the pose's surface in space seen empty before, plus the reverse
 * @property {Candidate[]} [candidates]  candidates that fit, the best first
 * @property {number | null} [candidate]  index of the refined candidate; null: from pairs of points
 *
 * @typedef {{object_from_platform: number[][], overlap: number, residual_mm: number, contradiction: number}} Candidate
 *
 * @typedef {Object} Pose
 * @property {number} pose  from 1
 * @property {string} scan  id of the pose's scan
 * @property {import('./api.js').Scan['state']} state
 * @property {Registration | null} registration
 */

const path = (/** @type {string} */ scan) => `scans/${encodeURIComponent(scan)}/poses`;

/** @param {string} scan @returns {Promise<import('./api.js').Scan>} the scan of the object's current pose */
export const startPose = (scan) => json(path(scan), sending('POST'));

/** @param {string} scan @param {number} pose @returns {Promise<import('./api.js').Scan>} the scan without that pose */
export const removePose = (scan, pose) => json(`${path(scan)}/${pose}`, sending('DELETE'));

/**
 * Samples of the points seen before, in the object's frame, and of this pose's points, in its platform frame.
 * @param {string} scan @param {number} pose @returns {Promise<{before_mm: number[][], pose_mm: number[][]}>}
 */
export const posePoints = (scan, pose) => json(`${path(scan)}/${pose}/points`);

/** @param {string} scan @param {number} pose @param {Object} choice @returns {Promise<import('./api_builds.js').Build>} the new build of all poses */
export const choosePose = (scan, pose, choice) => json(`${path(scan)}/${pose}`, sending('POST', choice));
