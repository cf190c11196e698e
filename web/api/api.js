// Requests to the scanner. API.md describes the responses.

import {parse, root} from '../base/address.js';
import {text} from '../base/texts.js';
import {refusalText} from '../base/wording.js';

/**
 * @typedef {Object} Settings
 * @property {number} snapshots
 * @property {'basic' | 'average' | 'average-discard'} filter
 * @property {number} frames
 * @property {'solid' | 'intersection'} method
 * @property {number} leaf_size_mm
 * @property {number} threshold_m2
 * @property {'auto' | 'told'} calibrate  whether a scan solves the sensor's pose itself
 * @property {number[]} clip_mm  x0 y0 z0 x1 y1 z1
 * @property {number[][]} [platform_from_sensor]
 * @property {number} [depth_scale]
 *
 * @typedef {import('../base/wording.js').Parameters} Parameters
 * @typedef {{code: string, detail: string, hint: string, parameters?: Parameters, places_mm?: number[][]}} Reason  places_mm: affected places, in the model's frame
 *
 * @typedef {Object} Model
 * @property {string} url
 * @property {number} bytes
 * @property {number} triangles
 * @property {number} leaves
 * @property {boolean} watertight
 * @property {number} volume_cm3
 * @property {number[]} size_mm
 * @property {number} seconds
 * @property {number | null} parts
 * @property {number | null} [dropped_parts]  parts left out of the model
 * @property {number | null} [dropped_volume_cm3]
 * @property {number | null} filled_share  share of the surface's area that was not observed
 * @property {{verdict: 'good' | 'look' | 'bad', reasons: Reason[], size_error?: {mm: number, of_mm: number}} | null} [quality]
 *
 * @typedef {{accepted: boolean, confirms_told: boolean, reason: string, solved: {after_mm: number} | null, findings?: Reason[]}} ScanCalibration
 *
 * @typedef {Object} Scan
 * @property {string} id
 * @property {string} name
 * @property {string} notes
 * @property {string[]} tags
 * @property {string} inventory_number
 * @property {string} author
 * @property {string} licence
 * @property {'running' | 'paused' | 'finished' | 'cancelled' | 'failed' | 'interrupted'} state
 * @property {'starting' | 'turning' | 'capturing' | 'calibrating' | 'rebuilding' | 'registering' | 'building' | 'done'} phase
 * @property {string} created
 * @property {number} snapshots_done
 * @property {number} snapshots_total
 * @property {number} seconds_elapsed
 * @property {number | null} seconds_left
 * @property {number | null} seconds_until_pause  while a failed stop is retried
 * @property {boolean} [can_resume]
 * @property {Settings} settings
 * @property {number} late_pulses  motor pulses that came late
 * @property {number} slips  pictures that showed lost steps
 * @property {number} seconds_settling  that a stop waited at most for a platform that swung on
 * @property {{code: string, detail: string, hint: string, parameters?: Parameters} | null} error  in a running scan, the error for which a stop is retried
 * @property {Model | null} model
 * @property {ScanCalibration | null} [calibration]  solved by the scan itself
 * @property {number} [build]  the build that `model` is from; 0: the scan itself
 * @property {{scan: string, registration: import('./api_poses.js').Registration | null} | null} [pose_of]  for a scan of a further pose
 * @property {import('./api_poses.js').Pose[]} [poses]  further poses of the same object
 * @property {boolean} [has_colours]  whether its pictures are coloured
 * @property {boolean} [has_views]  whether its models tell how many snapshots saw a place
 * @property {{url: string, snapshots: number} | null} preview  mesh of the snapshots so far; null unless it runs
 *
 * @typedef {Partial<Pick<Scan, 'name' | 'notes' | 'tags' | 'inventory_number' | 'author' | 'licence'>>} Label
 *
 * @typedef {Object} Device
 * @property {'unknown' | 'ready' | 'missing' | 'failed'} state
 * @property {string} name
 * @property {boolean} simulated
 * @property {string} message
 *
 * @typedef {Object} Status
 * @property {string} version
 * @property {Device} sensor
 * @property {Device} turntable
 * @property {number} disk_free_bytes
 * @property {boolean} appliance  whether it has updates and WiFi
 * @property {Finding[]} [warnings]  about the computer
 * @property {Scan | null} scan
 * @property {import('./api_builds.js').Build | null} [build]  the running build, or the last one
 * @property {import('./api_builds.js').Build[] | null} [cluster_builds]  builds in Slurm; null: the scanner builds by itself
 * @property {string | null} newest
 * @property {number} scans_revision  changes whenever a scan is added, ends, is renamed or deleted
 *
 * @typedef {Object} Finding  the result of one check
 * @property {string} check  machine-readable name of the check
 * @property {string} name
 * @property {'ok' | 'warning' | 'fault' | 'unknown'} state
 * @property {string} measured  with units
 * @property {string} advice  remedy, or empty
 * @property {'' | 'measure-turn' | 'set-pose' | 'open-settings' | 'choose-scans'} action  remedy that the page offers
 *
 * @typedef {Object} Report  the report of the scanner's doctor
 * @property {string} version
 * @property {string} time
 * @property {'ok' | 'warning' | 'fault'} state
 * @property {Finding[]} findings
 *
 * @typedef {Object} Update
 * @property {string} version  running version
 * @property {string} slot
 * @property {'none' | 'receiving' | 'installing' | 'restarting' | 'failed' | 'trial' | 'kept' | 'returned'} state
 * @property {string} update_version
 * @property {string} error
 *
 * @typedef {Object} Network
 * @property {string} name
 * @property {number} signal_dbm
 * @property {boolean} secured
 *
 * @typedef {Object} Wifi
 * @property {'none' | 'joining' | 'joined' | 'failed' | 'hotspot'} state
 * @property {string} name
 * @property {string} country
 * @property {string} hotspot
 * @property {string} error
 * @property {string} host  the scanner's host name
 * @property {Network[]} networks  strongest first
 */

const patience = 8000;  // request timeout, milliseconds
const patienceWithFile = 600000;  // timeout while a file is sent
const patienceWithDoctor = 60000;  // timeout of a check, which waits for the sensor and watches it

/** The scanner's refusal of a request, from its problem+json. */
export class Problem extends Error {
  /**
   * @param {string} code  "unreachable" if there was no response
   * @param {string} title
   * @param {string} [detail]
   * @param {string} [hint]
   * @param {Parameters} [parameters]  the values in `detail`
   */
  constructor(code, title, detail = '', hint = '', parameters = {}) {
    super(detail || title);
    this.name = 'Problem';
    this.code = code;
    this.title = title;
    this.detail = detail;
    this.hint = hint;
    this.parameters = parameters;
  }
}

const unreachable = () => new Problem('unreachable', text('problem.unreachable'), '',
    text('problem.unreachable-hint'));

/** @param {Response} response */
async function problemOf(response) {
  const isProblem = response.headers.get('Content-Type')?.startsWith('application/problem+json');
  const body = isProblem ? await response.json().catch(() => ({})) : {};
  const code = body.code ?? 'http';
  return new Problem(code, body.title || text('problem.http', {status: String(response.status)}), refusalText({...body, code}), body.hint, body.parameters);
}

/**
 * @param {string} path  below the API's root, or an address of an answer
 * @param {RequestInit} [options]
 * @param {number} [timeout]  milliseconds
 * @returns {Promise<Response>} with a status of success
 * @throws {Problem}
 */
async function request(path, options = {}, timeout = patience) {
  let response;
  try {
    response = await fetch(path.startsWith(root) ? path : root + path,
        {signal: AbortSignal.timeout(timeout), cache: 'no-cache', ...options});
  } catch (error) {
    throw options.signal?.aborted ? error : unreachable();
  }
  if (!response.ok) {
    throw await problemOf(response);
  }
  return response;
}

/**
 * @param {string} path
 * @param {RequestInit} [options]
 * @param {number} [timeout]  milliseconds
 */
export async function json(path, options, timeout) {
  const response = await request(path, options, timeout);
  try {
    return parse(await response.text());
  } catch {
    throw unreachable();  // truncated, or not from the scanner
  }
}

/**
 * @param {string} method
 * @param {Object} [body]
 * @returns {RequestInit}
 */
export const sending = (method, body = {}) => ({
  method,
  headers: {'Content-Type': 'application/json'},
  body: JSON.stringify(body),
});

/** @param {string} path @param {string} method */
export const withoutAnswer = (path, method) => request(path, {method, headers: {'Content-Type': 'application/json'}});

const scan = (/** @type {string} */ id) => `scans/${encodeURIComponent(id)}`;

/** @returns {Promise<Status>} */
export const status = () => json('status');

/** Checks the scanner, which takes a few seconds. @returns {Promise<Report>} */
export const examine = () => json('doctor', {}, patienceWithDoctor);

/** @returns {Promise<Scan[]>} newest first */
export const scans = async () => (await json('scans')).scans;

/** What a visit begins with: the defaults of the form, and the formats of models. @returns {Promise<{defaults: Settings, formats: string[]}>} */
export const configured = async () => {
  const {defaults: form, model_formats} = await json('settings');
  return {defaults: form, formats: model_formats};
};

/** @returns {Promise<Settings>} the default settings of a scan */
export const defaults = async () => (await configured()).defaults;

/**
 * @param {Partial<Settings> & Label} settings
 * @returns {Promise<Scan>}
 */
export const start = (settings) => json('scans', sending('POST', settings));

/** @param {string} id @returns {Promise<Scan>} */
export const cancel = (id) => json(`${scan(id)}/cancel`, sending('POST'));

/** @param {string} id @returns {Promise<Scan>} */
export const pause = (id) => json(`${scan(id)}/pause`, sending('POST'));

/** @param {Partial<Settings>} settings @returns {Promise<{seconds: number, bytes: number, measured: boolean}>} time and disk space of such a scan */
export const estimate = (settings) => json('scans/estimate', sending('POST', settings));

/** @param {string} id  of a scan that was paused, interrupted or ended @returns {Promise<Scan>} */
export const resume = (id) => json(`${scan(id)}/resume`, sending('POST'));

/** @param {Blob} file  a raw scan of this or another Octurn @returns {Promise<Scan>} */
export const importScan = (file) => json('scans/import',
    {method: 'POST', headers: {'Content-Type': 'application/octet-stream'}, body: file}, patienceWithFile);

/** @param {string} id @param {Label} what @returns {Promise<Scan>} */
export const label = (id, what) => json(scan(id), sending('PATCH', what));

/** @param {string} id */
export const remove = (id) => withoutAnswer(scan(id), 'DELETE');

/** @returns {Promise<Blob>} the sensor's current picture, a PNG */
export const preview = async () => (await request('preview/depth.png')).blob();

/**
 * The coarse preview mesh of a running scan.
 *
 * @param {string} url
 * @param {AbortSignal} signal
 * @returns {Promise<ReadableStream<Uint8Array>>}
 */
export async function growing(url, signal) {
  const {body} = await request(url, {signal, cache: 'no-cache'});
  return /** @type {ReadableStream<Uint8Array>} */ (body);
}

/**
 * A finished model as a stream. The download may take minutes, and the browser may cache it.
 *
 * @param {string} url
 * @param {AbortSignal} signal
 * @returns {Promise<ReadableStream<Uint8Array>>}
 */
export async function model(url, signal) {
  const {body} = await request(url, {signal, cache: 'default'});
  return /** @type {ReadableStream<Uint8Array>} */ (body);
}

/**
 * Asks whether a file can be downloaded.
 * @param {string} url
 * @throws {Problem} the refusal; only the answer to a GET has its reason
 */
export const expectFile = (url) => request(url, {method: 'HEAD'}, patienceWithFile).catch(async () => {
  (await request(url, {}, patienceWithFile)).body?.cancel();
});

/** @returns {Promise<Update>} available on an appliance only */
export const update = () => json('update');

/** @returns {Promise<Wifi>} available on an appliance only */
export const wifi = () => json('wifi');

/** @param {{name: string, password?: string, country: string}} wanted @returns {Promise<Wifi>} */
export const joinWifi = (wanted) => json('wifi', sending('PUT', wanted));

/**
 * Uploads an update, which may take minutes.
 *
 * @param {Blob} file
 * @param {(sent: number) => void} onProgress  bytes so far
 * @param {AbortSignal} signal
 * @param {boolean} takesOlder  whether a version older than the running one is allowed
 * @returns {Promise<Update>}
 */
export const sendUpdate = (file, onProgress, signal, takesOlder) => new Promise((resolve, reject) => {
  const request = new XMLHttpRequest();  // fetch has no upload progress
  request.open('PUT', `${root}update${takesOlder ? '?older=yes' : ''}`);
  request.setRequestHeader('Content-Type', 'application/octet-stream');
  request.upload.addEventListener('progress', ({loaded}) => onProgress(loaded));
  request.addEventListener('load', () => {
    const headers = {'Content-Type': request.getResponseHeader('Content-Type') ?? ''};
    const response = new Response(request.responseText, {status: request.status, headers});
    (response.ok ? response.json() : problemOf(response).then((problem) => Promise.reject(problem))).then(resolve, reject);
  });
  request.addEventListener('error', () => reject(unreachable()));
  request.addEventListener('abort', () => reject(signal.reason));
  signal.addEventListener('abort', () => request.abort());
  request.send(file);
});
