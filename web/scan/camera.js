// The live picture while it is in view. Of a depth sensor: readings in the scanned space in colour, and hints on problems of a scan.

import * as api from '../api/api.js';
import * as requests from '../api/api_calibration.js';
import {drawDepth, drawLight, drawScale} from '../sensor/depth.js';
import {element, part, setText, show} from '../base/dom.js';
import {spaceChosen} from './form.js';
import {sentence} from '../base/format.js';
import {hintOf, movedShare, seenOf, steadyHint} from '../sensor/live_hints.js';
import {drawLines, prepareDistance} from '../sensor/rig_picture.js';
import {text} from '../base/texts.js';

/** @typedef {import('../sensor/live_hints.js').Rig} Rig */
/** @typedef {import('../sensor/live_hints.js').Seen} Seen */

const betweenPictures = 250;   // milliseconds; the scanner may be busy with a scan
const betweenAttempts = 2000;  // milliseconds, while there is no picture
const betweenRigs = 5000;      // a calibration may change the pose

const isWatched = () => !document.hidden && !element('main').hidden && !element('camera').hidden && element('stage').dataset.reachable === 'yes';

/** @type {Pick<Rig, 'pose' | 'sensor'> | null} */
let told = null;
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
    told = {pose, sensor: told?.sensor ?? (await requests.points()).sensor};
  } catch {
    told = null;
  }
}

/** @returns {Rig | null} */
function rigNow() {
  const clip_mm = spaceChosen();
  return told && clip_mm ? {...told, clip_mm} : null;
}

/** @type {{brightness: Uint8Array, seen: Seen} | null} the previous picture */
let before = null;
let steady = steadyHint();

/** @param {Uint8Array} brightness @param {Seen | null} seen @param {Rig | null} rig */
function showHint(brightness, seen, rig) {
  const isIdle = element('stage').dataset.hints === 'yes' && element('stage').dataset.live === 'yes';
  const moved = seen && before ? movedShare(brightness, before.brightness, seen, before.seen) : 0;
  before = seen && {brightness, seen};
  if (!isIdle) {
    steady = steadyHint();
  }
  const hint = isIdle && seen && rig ? steady(hintOf(seen, moved, rig.clip_mm)) : null;
  show(element('live-hint'), hint !== null);
  if (hint) {
    element('live-hint').dataset.tone = hint.tone;
    element('live-hint').dataset.code = hint.code;
    setText(element('hint-text'), hint.text);
    setText(element('hint-detail'), hint.detail);
  }
}

/** @type {(brightness: Uint8Array) => void} */
let seeDistances = () => {};

async function showPicture() {
  try {
    await askForRig();
    const canvas = element('depth');
    if (element('stage').dataset.sees === 'light') {
      await drawLight(canvas, await api.preview());
      show(element('no-picture'), false);
      return betweenPictures;
    }
    const rig = rigNow();
    /** @type {Seen | null} */
    let seen = null;
    const brightness = await drawDepth(canvas, await api.preview(), (picture) => {
      seen = rig && seenOf(picture, canvas.width, rig);
      return seen?.inside ?? null;
    });
    show(element('live-lines'), rig !== null);
    rig && drawLines(element('live-lines'), rig);
    seeDistances(brightness);
    showHint(brightness, seen, rig);
    show(element('no-picture'), false);
    return betweenPictures;
  } catch (error) {
    const {detail, title, hint} = error instanceof api.Problem ? error : new api.Problem('picture', text('problem.picture'));
    setText(element('no-picture-text'), [detail || title, hint].map(sentence).join(' '));
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
