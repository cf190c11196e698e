// Requests about what the scanner is told to keep, and about its turntable. What it answers is described in API.md.

import {json, sending} from './api.js';

/**
 * @typedef {Object} SettingSchema  of one setting
 * @property {string} type
 * @property {string} description
 * @property {string} [x-unit]
 * @property {number} [minimum]
 * @property {number} [maximum]
 * @property {number} [minItems]
 * @property {(string | number)[]} [enum]
 *
 * @typedef {Object} Configuration
 * @property {any} settings  in force, every key
 * @property {any} preset  what they are where the page has set nothing
 * @property {any} stored  what the page has set
 * @property {any} settings_schema
 * @property {string[]} restart_needed  keys that are not in force yet
 * @property {string} trouble  with the stored ones, or empty
 * @property {'everybody' | 'page' | 'octurn.json'} password
 *
 * @typedef {{name: string, time_zone: string, error: string}} Machine  of the appliance
 *
 * @typedef {{code: string, detail: string, hint: string}} Trouble
 *
 * @typedef {Object} TurnFinding  of a test of the turntable
 * @property {string} check
 * @property {string} name
 * @property {'ok' | 'warning' | 'fault'} state
 * @property {string} measured
 * @property {string} advice
 * @property {Object} set  settings of the turntable that cure it
 *
 * @typedef {Object} TurntableState
 * @property {'idle' | 'jogging' | 'testing'} state
 * @property {Trouble | null} error  of the last jog
 * @property {{state: 'running' | 'done' | 'failed' | 'cancelled', done: number, findings: TurnFinding[], error: Trouble | null} | null} test
 */

/** @returns {Promise<Machine>} of the appliance alone */
export const machine = () => json('machine');

/** @param {{name?: string, time_zone?: string}} wanted @returns {Promise<Machine>} as it is before that is done */
export const changeMachine = (wanted) => json('machine', sending('PATCH', wanted));

/** @returns {Promise<TurntableState>} */
export const turntable = () => json('turntable');

/** @param {Object} what  {jog_deg}, {test: true} or {stop: true} @returns {Promise<TurntableState>} */
export const moveTurntable = (what) => json('turntable', sending('POST', what));

/** @returns {Promise<Configuration>} */
export const configuration = () => json('settings');

/** @param {Object} change  null takes back what was set @returns {Promise<Configuration>} */
export const changeSettings = (change) => json('settings', sending('PATCH', change));

/** @param {string} backup  the text of its file @returns {Promise<Configuration>} */
export const restoreSettings = (backup) => json('settings/backup', {...sending('POST'), body: backup});

/** @param {string | null} password  null lets everybody in @returns {Promise<Configuration>} */
export const setPassword = (password) => json('settings/password', sending('PUT', {password}));
