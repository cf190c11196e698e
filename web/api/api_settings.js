// Requests about the scanner's settings and its turntable. API.md describes the responses.

import {json, sending} from './api.js';
import {md5} from '../base/md5.js';

/**
 * @typedef {Object} SettingSchema  JSON schema of one setting
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
 * @property {any} preset  values without the page's settings
 * @property {any} stored  values set by the page
 * @property {any} settings_schema
 * @property {string[]} restart_needed  keys that are not in force yet
 * @property {string} trouble  problem with the stored settings, or empty
 * @property {'everybody' | 'page' | 'octurn.json'} password
 *
 * @typedef {{name: string, time_zone: string, error: string}} Machine  name and time of the appliance
 *
 * @typedef {{code: string, detail: string, hint: string}} Trouble
 *
 * @typedef {Object} TurnFinding  a result of the turntable's test
 * @property {string} check
 * @property {string} name
 * @property {'ok' | 'warning' | 'fault'} state
 * @property {string} measured
 * @property {string} advice
 * @property {Object} set  turntable settings that remedy it
 *
 * @typedef {Object} TurntableState
 * @property {'idle' | 'jogging' | 'testing'} state
 * @property {Trouble | null} error  of the last jog
 * @property {{state: 'running' | 'done' | 'failed' | 'cancelled', done: number, findings: TurnFinding[], error: Trouble | null} | null} test
 */

/** @returns {Promise<Machine>} available on an appliance only */
export const machine = () => json('machine');

/** @param {{name?: string, time_zone?: string}} wanted @returns {Promise<Machine>} as before the change */
export const changeMachine = (wanted) => json('machine', sending('PATCH', wanted));

/** @returns {Promise<TurntableState>} */
export const turntable = () => json('turntable');

/** @param {Object} what  {jog_deg}, {test: true} or {stop: true} @returns {Promise<TurntableState>} */
export const moveTurntable = (what) => json('turntable', sending('POST', what));

/** @returns {Promise<Configuration>} */
export const configuration = () => json('settings');

/** @param {Object} change  null resets a setting @returns {Promise<Configuration>} */
export const changeSettings = (change) => json('settings', sending('PATCH', change));

/** @param {string} backup  the text of its file @returns {Promise<Configuration>} */
export const restoreSettings = (backup) => json('settings/backup', {...sending('POST'), body: backup});

/** @param {string | null} password  null removes the password @returns {Promise<Configuration>} */
export const setPassword = (password) => json('settings/password',
    sending('PUT', password === null ? {password} : {hash: md5(`octurn:Octurn:${password}`)}));
