// Tools for the model in the large picture: measure between two points, cut it open, lay it on another side.

import {element, pressed, setText, show} from '../base/dom.js';
import * as format from '../base/format.js';
import {measureText, withPoint} from '../model/measure.js';
import {text} from '../base/texts.js';

/** @typedef {import('../model/viewer.js').Viewer} Viewer */
/** @typedef {import('../model/colours.js').Paint} Paint */

/** @type {() => Viewer | undefined} */
let viewer = () => undefined;
/** @type {number[][] | null} measured points; null: the tool is off */
let measuring = null;
/** @type {'upright' | 'waiting' | 'laid'} waiting: for the side to lay the model on */
let lying = 'upright';
/** @type {{url: string | null, paint: Paint | null}} the STL of the model that can be painted */
let painted = {url: null, paint: 'colours'};

/** @param {string} words  shown on the picture; empty: none */
function say(words) {
  show(element('measured'), words !== '');
  setText(element('measured'), words);
}

function render() {
  pressed('measure', measuring !== null);
  pressed('lay', lying !== 'upright');
  element('view').dataset.measuring = measuring || lying === 'waiting' ? 'yes' : 'no';
  const words = measuring ? measureText(measuring) : lying === 'waiting' ? text('view.lay-which') : '';
  say(words);
}

/** @param {number[][] | null} points_mm */
function setMeasure(points_mm) {
  measuring = points_mm;
  lying = lying === 'waiting' ? 'upright' : lying;
  viewer()?.showMeasure(points_mm ?? []);
  render();
}

/** @param {typeof lying} next @param {number[]} [place_mm]  of the side on which the model is laid */
function setLying(next, place_mm) {
  const isMoved = next === 'laid' || lying === 'laid';
  lying = next;
  if (isMoved) {
    viewer()?.lay(place_mm ?? null);
    setCut(false);
  }
  measuring = null;
  viewer()?.showMeasure([]);
  render();
}

/** @param {number} share  of the model's height */
function cutAt(share) {
  setText(element('cut-at'), format.millimetres(viewer()?.cut(share) ?? 0, 1));
}

/** @param {boolean} isCut */
function setCut(isCut) {
  pressed('cut', isCut);
  show(element('cut-height'), isCut);
  cutAt(isCut ? element('cut-share').valueAsNumber : 1);
}

/**
 * Offers colours for the shown model, which is drawn in clay at first.
 * @param {string | null} url  of its STL; null: it has none @param {Paint | null} paint  which it has
 */
export function offerPaints(url, paint) {
  painted = {url, paint};
  for (const id of ['colours', 'views']) {
    pressed(id, false);
    show(element(id), url !== null && id === paint);
  }
  show(element('legend'), false);
}

/** Handles a click on the model. @param {number[]} place_mm */
export function useTool(place_mm) {
  if (measuring) {
    setMeasure(withPoint(measuring, place_mm));
  } else if (lying === 'waiting') {
    setLying('laid', place_mm);
  }
}

/** Resets the pose when another mesh of the same object is shown, which stands as scanned. */
export function standUp() {
  lying = lying === 'laid' ? 'upright' : lying;
  render();
}

/** Resets all tools for another model. */
export function putToolsAway() {
  lying = 'upright';
  setMeasure(null);
  setCut(false);
}

/** @param {() => Viewer | undefined} shown */
export function prepareTools(shown) {
  viewer = shown;
  element('measure').addEventListener('click', () => setMeasure(measuring ? null : []));
  for (const id of ['colours', 'views']) {
    element(id).addEventListener('click', async () => {
      const {togglePaint} = await import('../model/colours.js');
      togglePaint({viewer, painted: () => painted, say: (words) => words === '' ? render() : say(words)});
    });
  }
  element('lay').addEventListener('click', () => setLying(lying === 'upright' ? 'waiting' : 'upright'));
  element('cut').addEventListener('click', () => {
    element('cut-share').value = 0.5;
    setCut(element('cut').getAttribute('aria-pressed') !== 'true');
  });
  element('cut-share').addEventListener('input', () => cutAt(element('cut-share').valueAsNumber));
}
