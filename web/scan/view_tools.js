// Tools for the model in the large picture: measure it, cut it open, lay it on another side, erase a part, and make a
// model of that.

import * as api from '../api/api.js';
import {element, pressed, setText, show} from '../base/dom.js';
import * as format from '../base/format.js';
import {measureDrawing, measureText, sectionText, sizeDrawing, sizeText, withPoint} from '../model/measure.js';
import {boxOf, planeInModel, sectionOf} from '../model/section.js';
import {readStl} from '../model/stl.js';
import {text} from '../base/texts.js';

/** @typedef {import('../model/viewer.js').Viewer} Viewer */
/** @typedef {import('../model/colours.js').Paint} Paint */
/** @typedef {import('../model/measure.js').Kind} Kind */

const kinds = /** @type {Kind[]} */ (['distance', 'diameter', 'angle', 'size']);
const axes = ['x', 'y', 'z'];
const cutSides = [1, -1, 1];  // what is cut off along X, Y and Z is on the side from which the model is first seen

/** @type {() => Viewer | undefined} */
let viewer = () => undefined;
/** @type {typeof import('./make_model.js').makeModel | null} */
let maker = null;
/** @type {Kind | null} what is measured; null: the tool is off */
let measuring = null;
/** @type {number[][]} measured points */
let points = [];
/** @type {number | null} the axis along which the model is cut; null: it is whole */
let cutAxis = null;
/** @type {'upright' | 'waiting' | 'laid'} waiting: for the side to lay the model on */
let lying = 'upright';
/** @type {number[][] | null} balls to erase, in the model's frame; null: the tool is off */
let erasing = null;
/** @type {{url: string | null, paint: Paint | null, isSolid: boolean}} the STL of the model that can be painted, edited */
let painted = {url: null, paint: 'colours', isSolid: false};
/** @type {{url: string, positions: Float32Array | null} | null} the STL's corners; without positions while they load */
let corners = null;

/** @param {string} words  shown on the picture; empty: none */
function say(words) {
  show(element('measured'), words !== '');
  setText(element('measured'), words);
}

/** The corners of the model, if they are here. They are kept only while a tool needs them. */
function loadedCorners() {
  const {url} = painted;
  if (url === null || corners?.url === url) {
    return corners?.positions ?? null;
  }
  const loading = {url, positions: /** @type {Float32Array | null} */ (null)};
  corners = loading;
  api.model(url, new AbortController().signal).then(readStl).then(({positions}) => {
    loading.positions = positions;
    corners === loading && render();
  }, () => {
    corners = corners === loading ? null : corners;
  });
  return null;
}

/** The plane of the cut, in the view. */
function cutPlane() {
  const shown = viewer();
  if (cutAxis === null || !shown) {
    return null;
  }
  const {min, max} = shown.box;
  const at = min[cutAxis] + element('cut-share').valueAsNumber * (max[cutAxis] - min[cutAxis]);
  const side = cutSides[cutAxis];
  return {normal: [0, 1, 2].map((axis) => axis === cutAxis ? side : 0), distance: side * at};
}

/** What is said of the section. */
function cutText() {
  const [shown, plane] = [viewer(), cutPlane()];
  const positions = plane && loadedCorners();
  if (!shown || !plane || !positions) {
    return '';
  }
  const pose = shown.pose();
  const [u, v] = pose.axes.filter((_, axis) => axis !== cutAxis);
  return sectionText(sectionOf(positions, planeInModel(plane, pose), u, v));
}

/** What is said of the measurement, which is drawn. @param {Kind} kind */
function measured(kind) {
  const shown = viewer();
  if (kind !== 'size') {
    shown?.showDrawing(measureDrawing(kind, points));
    return measureText(kind, points);
  }
  const positions = loadedCorners();
  if (!shown || (painted.url !== null && !positions)) {
    return text('view.loading');
  }
  const box = positions ? boxOf(positions, shown.pose()) : shown.box;  // of a preview, which stands as scanned
  shown.showDrawing(sizeDrawing(box));
  return sizeText(box);
}

/** What the tools say. */
function words() {
  if (measuring) {
    return measured(measuring);
  }
  viewer()?.showDrawing(null);
  return lying === 'waiting' ? text('view.lay-which') : erasing?.length === 0 ? text('view.erase-where') : cutText();
}

function render() {
  pressed('measure', measuring !== null);
  pressed('cut', cutAxis !== null);
  pressed('lay', lying !== 'upright');
  pressed('erase', erasing !== null);
  show(element('measure-kinds'), measuring !== null);
  kinds.forEach((kind) => pressed(`measure-${kind}`, measuring === kind));
  show(element('cut-axes'), cutAxis !== null);
  show(element('cut-place'), cutAxis !== null);
  axes.forEach((name, axis) => pressed(`cut-${name}`, axis === cutAxis));
  show(element('erase'), painted.url !== null && painted.isSolid);
  show(element('erase-size'), erasing !== null);
  setText(element('erase-at'), format.millimetres(element('erase-radius').valueAsNumber, 1));
  const isChanged = cutAxis !== null || Boolean(erasing?.length);
  show(element('make-model'), painted.url !== null && (isChanged ? painted.isSolid : lying === 'laid'));
  const isPicking = (measuring && measuring !== 'size') || erasing || lying === 'waiting';
  element('view').dataset.measuring = isPicking ? 'yes' : 'no';
  const plane = cutPlane();
  viewer()?.cut(plane);
  const at = plane && cutAxis !== null ? plane.distance * cutSides[cutAxis] : 0;
  setText(element('cut-at'), format.millimetres(at, 1));
  say(words());
  if (cutAxis === null && measuring !== 'size') {
    corners = null;
  }
}

/** @param {number[][] | null} balls_mm */
function setErase(balls_mm) {
  erasing = balls_mm;
  viewer()?.showErased(balls_mm ?? []);
  measuring = null;
  render();
}

/** @param {Kind | null} kind @param {number[][]} [points_mm] */
function setMeasure(kind, points_mm = []) {
  if (erasing) {
    setErase(null);
  }
  measuring = kind;
  points = points_mm;
  lying = lying === 'waiting' ? 'upright' : lying;
  render();
}

/** @param {typeof lying} next @param {number[]} [place_mm]  of the side on which the model is laid */
function setLying(next, place_mm) {
  const isMoved = next === 'laid' || lying === 'laid';
  lying = next;
  if (isMoved) {
    viewer()?.lay(place_mm ?? null);
    viewer()?.showErased(erasing ?? []);
    cutAxis = null;
  }
  measuring = null;
  render();
}

/** @param {number | null} axis */
function setCut(axis) {
  cutAxis = axis;
  element('cut-share').value = 0.5;
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
  if (measuring && measuring !== 'size') {
    setMeasure(measuring, withPoint(measuring, points, place_mm));
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
  setCut(null);
}

/** Builds a model of what was cut, laid and erased. */
async function make() {
  const shown = viewer();
  if (shown && painted.url && maker) {
    await maker(painted.url, shown.pose(), {cut: cutPlane(), isLaid: lying === 'laid', erased: erasing ?? []});
  }
}

/** Sets what makes a model; it comes with the parts of a scan's page. @param {NonNullable<typeof maker>} make */
export function offerMaker(make) {
  maker = make;
}

/** Lets a button show or hide something of the model. @param {string} id @param {(isShown: boolean) => void} showIt */
const toggles = (id, showIt) => element(id).addEventListener('click', () => {
  const isShown = element(id).getAttribute('aria-pressed') !== 'true';
  pressed(id, isShown);
  showIt(isShown);
});

/** Attaches the handlers of the tools. @param {() => Viewer | undefined} shown */
export function prepareTools(shown) {
  viewer = shown;
  const click = (/** @type {string} */ id, /** @type {() => void} */ act) => element(id).addEventListener('click', act);
  toggles('turn', (isTurning) => viewer()?.turn(isTurning));
  toggles('filled', (isShown) => viewer()?.showFilled(isShown));
  toggles('edges', (areShown) => viewer()?.showEdges(areShown));
  click('reset-view', () => viewer()?.reset());
  click('measure', () => setMeasure(measuring ? null : 'distance'));
  kinds.forEach((kind) => click(`measure-${kind}`, () => setMeasure(kind)));
  for (const id of ['colours', 'views']) {
    click(id, async () => {
      const {togglePaint} = await import('../model/colours.js');
      togglePaint({viewer, painted: () => painted, say: (said) => said === '' ? render() : say(said)});
    });
  }
  click('lay', () => setLying(lying === 'upright' ? 'waiting' : 'upright'));
  click('cut', () => setCut(cutAxis === null ? 2 : null));
  axes.forEach((name, axis) => {
    setText(element(`cut-${name}`), name.toUpperCase());
    click(`cut-${name}`, () => setCut(axis));
  });
  click('erase', () => setErase(erasing ? null : []));
  element('erase-radius').addEventListener('input', () => {
    const radius = element('erase-radius').valueAsNumber;
    const last = erasing?.at(-1);
    erasing && setErase(last ? [...erasing.slice(0, -1), [...last.slice(0, 3), radius]] : erasing);
  });
  click('make-model', make);
  element('cut-share').addEventListener('input', render);
}
