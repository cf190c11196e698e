// The page Calibrate: polls the calibration, the picture and the points while the page is in view, and handles its
// buttons.

import * as api from '../api/api.js';
import * as requests from '../api/api_calibration.js';
import {changeSettings} from '../api/api_settings.js';
import {showCalibration, showMap, showNotice} from './calibrate_view.js';
import {scaleOf, turnStops} from './calibration.js';
import {chosenSpace, discardSpace, prepareSpace, showSpace} from '../sensor/clip_form.js';
import {element, setText, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {prepareLens, showLens} from './lens.js';
import {clearLengths, enteredLengths, prepareLengths} from './lengths.js';
import {here} from '../places.js';
import {chosenPose, discard, preparePlacement, showPlacement} from '../sensor/placement_form.js';
import {preparePicture, showClip, showNoPicture, showPicture, showPoints, showPose} from '../sensor/pose_picture.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api_calibration.js').Calibration} Calibration */

const wallFrames = 25;

/** @type {Calibration | null} */
let calibration = null;
let actions = 0;  // requests so far; a response from before the latest is outdated
let isPending = false;
/** @type {string | null} key of the map whose picture is shown */
let pictured = null;

const isWatched = () => here() === 'calibrate' && !document.hidden;

/** @param {unknown} error */
const problemOf = (error) => error instanceof api.Problem ? error : new api.Problem('page', String(error));

/**
 * The card for the lens of a camera with lasers, or of a Kinect's infrared camera; other sensors need none.
 * @type {Promise<void> | null}
 */
let lensCard = null;

/** @param {Calibration} news */
function see(news) {
  calibration = news;
  // A camera with lasers has no depth picture, so the cards for walls, known lengths and adjustment by hand are hidden.
  ['flatten', 'by-hand', 'known-length'].forEach((id) => show(element(id), !news.lens));
  if (news.lens || news.infrared) {
    lensCard ??= prepareLens(act, news.infrared);
    lensCard.then(() => showLens(calibration ?? news));
  }
  showCalibration(news);
  showPlacement(news.platform_from_sensor);
}

/**
 * Runs a request and shows its failure.
 * @param {string} failure  key of the failure's text @param {() => Promise<unknown>} action
 * @param {string} [notice]  id of the element that shows the failure
 */
async function act(failure, action, notice = 'pose-problem') {
  if (isPending) {
    return;
  }
  isPending = true;
  showNotice(notice, null);
  try {
    await action();
    see(await requests.calibration());
  } catch (error) {
    const {title, detail, hint} = problemOf(error);
    showNotice(notice, {title: text(failure), detail: [detail || title, hint].map(sentence).join(' ')});
  }
  ++actions;
  isPending = false;
}

async function keep() {
  const pose = chosenPose();
  if (pose) {
    await act('failure.pose', async () => {
      await requests.change({platform_from_sensor: pose});
      showPlacement(pose);  // in force now; the lines would otherwise show the pose before it until the scanner is asked
      discard();
    });
  }
}

async function keepSpace() {
  const clip_mm = chosenSpace();
  if (clip_mm) {
    await act('failure.space', async () => {
      const {defaults} = await changeSettings({scan: {clip_mm}});
      discardSpace();
      showSpace(defaults.clip_mm);
    });
  }
}

async function lookAtSpace() {
  try {
    showSpace((await api.defaults()).clip_mm);
    return 5000;
  } catch {
    return 2000;
  }
}

/** @param {Event} event */
function scale(event) {
  event.preventDefault();
  const wanted = scaleOf(enteredLengths(), calibration?.scale ?? 1);
  setText(element('known-problem'), wanted.problem);
  if (!wanted.problem) {
    act('failure.scale', async () => {
      await requests.change({scale: wanted.scale});
      clearLengths();
    });
  }
}

const isWallReady = () => [...element('wall-ready').querySelectorAll('input')].every((box) => box.checked);

function measureWall() {
  if (isWallReady()) {
    act('failure.wall', () => requests.measure({kind: 'wall', frames: wallFrames}));
  }
}

/** Fetches the picture of a map unless it is already shown. @param {Calibration} calibration */
async function lookAtMap({sensor_map: map}) {
  const mark = map && `${map.serial} ${map.at}`;
  if (mark !== pictured) {
    showMap(map && await requests.sensorMap());
    pictured = mark;
  }
}

async function lookAtCalibration() {
  const before = actions;
  try {
    const news = await requests.calibration();
    if (before === actions && !isPending) {
      see(news);
      await lookAtMap(news);
    }
  } catch {
    return 2000;
  }
  return calibration?.run?.state === 'running' ? 300 : 1500;
}

async function lookAtPicture() {
  if (!calibration) {
    return 250;
  }
  if (calibration.lens) {
    showNoPicture(text('lens.no-depth'));
    return 2000;
  }
  try {
    const [png, seen] = await Promise.all([api.preview(), requests.points()]);
    await showPicture(png, seen.sensor);
    showPoints(seen);
    return calibration?.run?.state === 'running' ? 1500 : 500;  // a turn needs the processor
  } catch (error) {
    const {detail, title, hint} = problemOf(error);
    showNoPicture([detail || title, hint].map(sentence).join(' '));
    return 2000;
  }
}

/** Polls while the page is in view. @param {() => Promise<number>} look  resolves to the pause after it, milliseconds */
async function watch(look) {
  for (;;) {
    const pause = isWatched() ? await look() : 250;
    await new Promise((done) => {
      setTimeout(done, pause);
    });
  }
}

function listen() {
  const click = (/** @type {string} */ id, /** @type {() => void} */ action) => element(id).addEventListener('click', action);
  click('measure-turn', () => act('failure.turn', () => requests.measure({kind: 'turn', stops: turnStops})));
  click('turn-cancel', () => act('failure.cancel-turn', requests.cancel));
  click('measure-wall', measureWall);
  click('wall-cancel', () => act('failure.cancel-wall', requests.cancel));
  click('forget-map', () => act('failure.forget-map', () => requests.change({sensor_map: null})));
  click('undo-optics', () => act('failure.undo-optics', () => requests.change({optics: null})));
  click('undo', () => act('failure.undo', requests.undo));
  click('unscale', () => act('failure.unscale', () => requests.change({scale: 1})));
  element('known').addEventListener('submit', scale);
  element('wall-ready').addEventListener('change', () => element('measure-wall').setAttribute('aria-disabled', String(!isWallReady())));
}

/** Called once, when the fragment is loaded. */
export function prepare() {
  preparePicture();
  prepareLengths();
  preparePlacement({onChange: showPose, onKeep: keep});
  listen();
  prepareSpace({onChange: showClip, onKeep: keepSpace});
  watch(lookAtSpace);
  watch(lookAtCalibration);
  watch(lookAtPicture);
}
