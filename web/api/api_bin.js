// Requests about deleted scans.

import {json, sending, withoutAnswer} from './api.js';

/** @typedef {{id: string, name: string, created: string, state: string, snapshots_done: number, deleted: string, kept_until: string}} Binned */

/** @returns {Promise<Binned[]>} the most recently deleted first */
export const bin = async () => (await json('bin')).scans;

/** @param {string} id @returns {Promise<import('./api.js').Scan>} */
export const restore = (id) => json(`scans/${encodeURIComponent(id)}/restore`, sending('POST'));

export const emptyBin = () => withoutAnswer('bin', 'DELETE');
