// Tools for the model in the large picture: measure between two points, cut it open, lay it on another side, erase a
// part, and make a model of that.

import {element, pressed, setText, show} from '../base/dom.js';
import * as format from '../base/format.js';
import {measureText, withPoint} from '../model/measure.js';
import {text} from '../base/texts.js';

/** @typedef {import('../model/viewer.js').Viewer} Viewer */
/** @typedef {import('../model/colours.js').Paint} Paint */

/** @type {() => Viewer | undefined} */
let viewer = () => undefined;
/** @type {typeof import('./make_model.js').makeModel | null} */
let maker = null;
/** @type {number[][] | null} measured points; null: the tool is off */
let measuring = null;
/** @type {'upright' | 'waiting' | 'laid'} waiting: for the side to lay the model on */
let lying = 'upright';
/** @type {number[][] | null} balls to erase, in the model's frame; null: the tool is off */
let erasing = null;
/** @type {{url: string | null, paint: Paint | null, isSolid: boolean}} the STL of the model that can be painted, edited */
let painted = {url: null, paint: 'colours', isSolid: false};

/** @param {string} words  shown on the picture; empty: none */
function say(words) {
  show(element('measured'), words !== '');
  setText(element('measured'), words);
}

function render() {
  pressed('measure', measuring !== null);
  pressed('lay', lying !== 'upright');
  pressed('erase', erasing !== null);
  show(element('erase'), painted.url !== null && painted.isSolid);
  show(element('erase-size'), erasing !== null);
  setText(element('erase-at'), format.millimetres(element('erase-radius').valueAsNumber, 1));
  const isChanged = isCut() || Boolean(erasing?.length);
  show(element('make-model'), painted.url !== null && (isChanged ? painted.isSolid : lying === 'laid'));
  element('view').dataset.measuring = measuring || erasing || lying === 'waiting' ? 'yes' : 'no';
  const words = measuring ? measureText(measuring) : lying === 'waiting' ? text('view.lay-which') :
    erasing?.length === 0 ? text('view.erase-where') : '';
  say(words);
}

const isCut = () => element('cut').getAttribute('aria-pressed') === 'true';

/** @param {number[][] | null} balls_mm */
function setErase(balls_mm) {
  erasing = balls_mm;
  viewer()?.showErased(balls_mm ?? []);
  measuring = null;
  viewer()?.showMeasure([]);
  render();
}

/** @param {number[][] | null} points_mm */
function setMeasure(points_mm) {
  if (erasing) {
    setErase(null);
  }
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
    viewer()?.showErased(erasing ?? []);
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

/** @param {boolean} isOn */
function setCut(isOn) {
  pressed('cut', isOn);
  show(element('cut-height'), isOn);
  cutAt(isOn ? element('cut-share').valueAsNumber : 1);
  render();
}

/**
 * Offers colours for the shown model, which is drawn in clay at first.
 * @param {string | null} url  of its STL; null: it has none @param {Paint | null} paint  which it has
 * @param {boolean} [isSolid]  whether it can be cut
 */
export function offerPaints(url, paint, isSolid = false) {
  painted = {url, paint, isSolid};
  for (const id of ['colours', 'views']) {
    pressed(id, false);
    show(element(id), url !== null && id === paint);
  }
  show(element('legend'), false);
  render();
}

/** Handles a click on the model. @param {number[]} place_mm */
export function useTool(place_mm) {
  const shown = viewer();
  if (measuring) {
    setMeasure(withPoint(measuring, place_mm));
  } else if (lying === 'waiting') {
    setLying('laid', place_mm);
  } else if (erasing && shown) {
    setErase([...erasing, [...shown.inModel(place_mm), element('erase-radius').valueAsNumber]]);
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
  setErase(null);
  setMeasure(null);
  setCut(false);
}

/** Builds a model of what was cut, laid and erased. */
async function make() {
  const shown = viewer();
  if (shown && painted.url && maker) {
    const cut = isCut() ? shown.cut(element('cut-share').valueAsNumber) : null;
    await maker(painted.url, shown.pose(), {cut, isLaid: lying === 'laid', erased: erasing ?? []});
  }
}

/** Sets what makes a model; it comes with the parts of a scan's page. @param {NonNullable<typeof maker>} make */
export function offerMaker(make) {
  maker = make;
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
    setCut(!isCut());
  });
  element('erase').addEventListener('click', () => setErase(erasing ? null : []));
  element('erase-radius').addEventListener('input', () => {
    const radius = element('erase-radius').valueAsNumber;
    const last = erasing?.at(-1);
    erasing && setErase(last ? [...erasing.slice(0, -1), [...last.slice(0, 3), radius]] : erasing);
  });
  element('make-model').addEventListener('click', make);
  element('cut-share').addEventListener('input', () => cutAt(element('cut-share').valueAsNumber));
}
