// The lens calibration of a camera with lasers, or of a Kinect's infrared camera, on the page Calibrate: a board is held
// in front of the camera, and the solved lens is kept or discarded. The fragment is fetched if the scanner has such a
// camera.

import * as api from '../api/api.js';
import * as requests from '../api/api_calibration.js';
import {showNotice} from './calibrate_view.js';
import {element, part, setText, show} from '../base/dom.js';
import {awaitFragment} from '../base/fragment.js';
import {foundLens, keptText, lensFiguresOf, lensOutcomeOf, lensProgressOf, opticsFiguresOf} from './lens_words.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api_calibration.js').Calibration} Calibration */

const cells = 6;

/** Solves the lens from the views of the board so far. */
const solve = () => api.json('calibration/solve', api.sending('POST'));

/** @type {Calibration | null} the last known calibration */
let latest = null;
let isDrawing = false;

/** @param {CanvasRenderingContext2D} context @param {import('../api/api_calibration.js').BoardLook} look */
function drawLook(context, {corners, coverage}) {
  const {width, height} = context.canvas;
  context.fillStyle = 'rgb(226 128 32 / 28%)';
  coverage.forEach((isSeen, cell) => {
    if (!isSeen) {
      context.fillRect(cell % cells * width / cells, Math.floor(cell / cells) * height / cells, width / cells, height / cells);
    }
  });
  context.strokeStyle = 'rgb(60 255 190)';
  context.lineWidth = 2;
  for (const [across, down] of corners) {
    context.beginPath();
    context.arc(across * width, down * height, 5, 0, 2 * Math.PI);
    context.stroke();
  }
}

/** Draws the camera's picture with the corners found in it; one picture at a time. */
async function drawPicture() {
  if (isDrawing) {
    return;
  }
  isDrawing = true;
  try {
    const bitmap = await createImageBitmap(await api.preview());
    const look = latest?.run?.look;
    const canvas = /** @type {HTMLCanvasElement} */ (element('lens-canvas'));
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
    bitmap.close();
    look && drawLook(context, look);
  } catch {
    // The run reports problems of the camera.
  }
  isDrawing = false;
}

/** @param {Calibration} calibration */
function showFigures(calibration) {
  const found = foundLens(calibration);
  const rows = !found ? [] : calibration.lens ? lensFiguresOf(found, calibration.lens.told) : opticsFiguresOf(found);
  show(element('lens-figures'), rows.length > 0);
  element('lens-figures').replaceChildren(...rows.map(({label, text, configured}) => {
    const row = document.createElement('div');
    const term = document.createElement('dt');
    const value = document.createElement('dd');
    term.textContent = label;
    const before = document.createElement('span');
    before.className = 'muted';
    before.textContent = configured;
    value.append(text, before);
    row.append(term, value);
    return row;
  }));
  show(element('lens-answers'), found !== null);
}

/** Words the card for a Kinect. */
function nameKinect() {
  /** @type {Record<string, string>} */
  const own = {'lens.title': 'lens.kinect', 'lens.about': 'lens.kinect-about',
    'lens.measure': 'lens.kinect-measure', 'lens.hold': 'lens.kinect-hold'};
  for (const node of /** @type {NodeListOf<HTMLElement>} */ (element('lens').querySelectorAll('[data-text]'))) {
    const key = own[node.dataset.text ?? ''];
    if (key) {
      node.dataset.text = key;
      setText(node, text(key));
    }
  }
  const help = part(element('lens'), 'a[href*="help/"]');
  help.setAttribute('href', 'help/calibration.html#the-optics-from-a-printed-board');
  show(element('lens-square'), true);
}

/** Has a board looked for, whose squares a Kinect has to know. @param {boolean} isKinect */
async function begin(isKinect) {
  const square = /** @type {HTMLInputElement} */ (element('lens-square-mm'));
  if (!isKinect) {
    await requests.measure({kind: 'lens'});
  } else if (square.reportValidity()) {
    await requests.measure({kind: 'lens', square_mm: square.valueAsNumber});
  }
}

/** Shows the state of the lens calibration. @param {Calibration} calibration */
export function showLens(calibration) {
  latest = calibration;
  const progress = lensProgressOf(calibration);
  const isBusy = calibration.run?.state === 'running';
  setText(element('lens-kept'), keptText(calibration));
  showNotice('lens-outcome', lensOutcomeOf(calibration));
  showFigures(calibration);
  show(element('lens-idle'), !isBusy && foundLens(calibration) === null);
  show(element('lens-forget'), calibration.lens?.kept !== null && calibration.lens?.kept !== undefined);
  show(element('lens-going'), progress !== null);
  show(element('lens-picture'), progress !== null);
  if (progress) {
    setText(element('lens-advice'), progress.advice);
    setText(element('lens-taken'), progress.taken);
    element('lens-progress').value = progress.share;
    show(element('lens-solve'), progress.canSolve);
    drawPicture();
  }
}

/**
 * Loads the card, once.
 * @param {(failure: string, action: () => Promise<unknown>, notice: string) => Promise<void>} act  sends a request, and shows a refusal in a notice
 * @param {boolean} isKinect
 */
export async function prepareLens(act, isKinect) {
  await awaitFragment(element('lens'), 'lens.html');
  if (isKinect) {
    nameKinect();
  }
  const click = (/** @type {string} */ id, /** @type {string} */ failure, /** @type {() => Promise<unknown>} */ action) =>
    part(element('lens'), `#${id}`).addEventListener('click', () => act(failure, action, 'lens-problem'));
  click('lens-begin', 'lens.not-begun', () => begin(isKinect));
  click('lens-cancel', 'lens.not-cancelled', requests.cancel);
  click('lens-solve', 'lens.not-solved', solve);
  click('lens-keep', 'lens.not-kept', () => requests.change({lens: 'keep'}));
  click('lens-discard', 'lens.not-kept', () => requests.change({lens: 'discard'}));
  click('lens-forget', 'lens.not-removed', () => requests.change({lens: null}));
  show(element('lens'), true);
}
