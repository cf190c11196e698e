// The live picture while it is in view. Of a depth sensor: readings in the scanned space in colour, and hints on problems of a scan.

import * as api from '../api/api.js';
import * as requests from '../api/api_calibration.js';
import {drawScale} from '../sensor/depth.js';
import {element, part, setText, show} from '../base/dom.js';
import {spaceChosen} from './form.js';
import {sentence} from '../base/format.js';
import {hintOf, steadyHint} from '../sensor/live_hints.js';
import {drawLines, prepareDistance} from '../sensor/rig_picture.js';
import {text, typeset} from '../base/texts.js';

/** @typedef {import('../sensor/live_picture.js').Rig} Rig */
/** @typedef {import('../sensor/live_reader.js').Reading} Reading */
/** @typedef {import('../sensor/live_reader.js').Request} Request */

const betweenPictures = 250;   // milliseconds; the scanner may be busy with a scan
const betweenAttempts = 2000;  // milliseconds, while there is no picture
const betweenRigs = 5000;      // a calibration may change the pose

const isWatched = () => !document.hidden && !element('main').hidden && !element('camera').hidden && element('stage').dataset.reachable === 'yes';

/** @type {Pick<Rig, 'pose' | 'sensor'> | null} */
let known = null;
let toldAt = -betweenRigs;  // by performance.now()

/** Fetches the sensor's pose from time to time. Without it the picture has no lines and no hints. */
async function askForRig() {
  if (performance.now() - toldAt < betweenRigs) {
    return;
  }
  toldAt = performance.now();
  try {
    const {platform_from_sensor: pose, lens} = await requests.recentCalibration();
    if (lens) {  // a camera with lasers measures no depth
      toldAt = Infinity;
      element('stage').dataset.sees = 'light';
      return;
    }
    known = {pose, sensor: known?.sensor ?? (await requests.points()).sensor};
  } catch {
    known = null;
  }
}

/** @returns {Rig | null} */
function rigNow() {
  const clip_mm = spaceChosen();
  return known && clip_mm ? {...known, clip_mm} : null;
}

/** @type {Worker | undefined} */
let reader;

/**
 * Reads a picture where workers have no canvas: in Safari before 16.4.
 * @param {Request} request @returns {Promise<Reading>}
 */
async function readHere(request) {
  const {readPicture} = await import('../sensor/live_reader.js');
  const {width, height} = request;
  return readPicture(Object.assign(document.createElement('canvas'), {width, height}), request);
}

/**
 * Has the worker read a picture. One is read at a time.
 * @param {Request} request @returns {Promise<Reading>} rejects if it is not a picture
 */
function read(request) {
  if (!('OffscreenCanvas' in globalThis)) {
    return readHere(request);
  }
  const worker = reader ??= new Worker(new URL('../sensor/live_worker.js', import.meta.url), {type: 'module'});
  return new Promise((resolve, reject) => {
    worker.onmessage = ({data}) => data.error ? reject(new Error(data.error)) : resolve(data);
    worker.onerror = () => {
      reader = undefined;  // it did not arrive: another one is asked for with the next picture
      reject(new Error('worker'));
    };
    worker.postMessage(request);
  });
}

let steady = steadyHint();

/** @param {Reading} reading @param {Rig | null} rig */
function showHint({seen, moved}, rig) {
  const isIdle = element('stage').dataset.hints === 'yes' && element('stage').dataset.live === 'yes';
  if (!isIdle) {
    steady = steadyHint();
  }
  const hint = isIdle && seen && rig ? steady(hintOf(seen, moved, rig)) : null;
  show(element('live-hint'), hint !== null);
  if (hint) {
    element('live-hint').dataset.tone = hint.tone;
    element('live-hint').dataset.code = hint.code;
    setText(element('hint-text'), hint.text);
    setText(element('hint-detail'), hint.detail);
  }
}

/** @type {ReturnType<typeof prepareDistance>} */
let seeDistances = () => {};

/** Why there is no picture, and what to do. What the panel beside it says is not said twice. @param {unknown} error */
function troubleText(error) {
  const {detail, title, hint} = error instanceof api.Problem ? error :
    new api.Problem('picture', text('problem.picture'));
  const told = element('panel').innerText;
  return [detail || title, hint].map(sentence).filter((words) => !told.includes(typeset(words))).join(' ') || text('stage.none');
}

async function showPicture() {
  try {
    await askForRig();
    const canvas = element('depth');
    const {width, height} = canvas;
    const isLight = element('stage').dataset.sees === 'light';
    const rig = isLight ? null : rigNow();
    const reading = await read({png: await api.preview(), width, height, isLight, rig});
    canvas.getContext('2d').putImageData(new ImageData(reading.pixels, width, height), 0, 0);
    show(element('no-picture'), false);
    if (reading.brightness) {
      show(element('live-lines'), rig !== null);
      rig && drawLines(element('live-lines'), rig);
      seeDistances(reading.brightness, rig?.sensor);
      showHint(reading, rig);
    }
    return betweenPictures;
  } catch (error) {
    setText(element('no-picture-text'), troubleText(error));
    show(element('no-picture'), true);
    show(element('live-hint'), false);
    return betweenAttempts;
  }
}

/** Runs as long as the page is open. */
export async function watchCamera() {
  drawScale(element('scale'));
  seeDistances = prepareDistance(part(element('camera'), '.frame'), element('live-pointed'));
  for (;;) {
    const pause = isWatched() ? await showPicture() : betweenPictures;
    await new Promise((done) => {
      setTimeout(done, pause);
    });
  }
}
