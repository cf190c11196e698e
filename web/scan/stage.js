// The large picture: the camera, or the model of the scan in view.

import * as api from '../api/api.js';
import {element, pressed, setText, show} from '../base/dom.js';
import {fetchFragment} from '../base/fragment.js';
import * as format from '../base/format.js';
import {coarseUrl, hasCoarse, loadsUnasked} from '../state.js';
import {readStl} from '../model/stl.js';
import {text} from '../base/texts.js';

/** @typedef {ReturnType<import('../screen.js').screenOf>['stage']} Stage */
/** @typedef {import('../api/api.js').Model} Model */

const isHandheld = matchMedia('(pointer: coarse)').matches;
const isStill = matchMedia('(prefers-reduced-motion: reduce)').matches;

/** @type {import('../model/viewer.js').Viewer | undefined} */
let viewer;
/** @type {Promise<void> | null} */
let opening = null;
/** @type {typeof import('./view_tools.js')} they come with the viewer */
let tools;
/** @type {string | null} url of the model that is shown, offered or loading */
let current = null;
let object = '';  // the scan of that model
/** @type {number[][] | null} marked places; null: the model is not loaded yet */
let marked = null;
/** @type {Stage | null} the stage to be shown */
let due = null;
let loading = new AbortController();

/** @param {string} words @param {{button?: string, progress?: number, isOver?: boolean}} [more]  isOver: whether a model is shown behind the note */
function note(words, {button, progress, isOver = false} = {}) {
  show(element('model-note'), words !== '');
  element('model-note').classList.toggle('over', isOver);
  show(element('model-tools'), words === '');
  setText(element('model-text'), words);
  show(element('model-progress'), progress !== undefined);
  element('model-progress').value = progress ?? 0;
  show(element('load-model'), button !== undefined);
  setText(element('load-model'), button ?? '');
}

async function openViewer() {
  const [{Viewer}, loaded] = await Promise.all([
    import('../model/viewer.js'), import('./view_tools.js'), fetchFragment(element('model-tools'), 'tools.html')]);
  viewer = new Viewer(element('view'), element('labels'), {
    onTurning: (isTurning) => pressed('turn', isTurning),
    onLost: () => note(text('view.lost'), {button: text('view.again')}),
    onPlace: loaded.useTool,
  });
  tools = loaded;
  tools.prepareTools(() => viewer);
}

/** Opens the viewer and its tools once. */
const awaitViewer = () => opening ??= openViewer().catch((error) => {
  opening = null;
  throw error;
});

/** Updates the marked places once the model is loaded. */
function markPlaces() {
  if (due && marked !== null && marked !== due.places && (marked.length > 0 || due.places.length > 0)) {
    marked = due.places;
    viewer?.showPlaces(marked);
  }
}

/**
 * @param {import('../model/stl.js').Mesh} mesh @param {boolean} isFirst  whether it is the first mesh of its object
 * @param {boolean} [isCoarse]  whether the whole model follows
 */
function put(mesh, isFirst, isCoarse = false) {
  show(element('filled'), mesh.filled !== null);
  viewer?.show(mesh, {isFirst, isGrowing: Boolean(due?.growing), isCoarse});
  tools.standUp();
  tools.offerPaints(due?.model?.url ?? null, due?.paint ?? null, due?.isSolid);
  if (isFirst) {
    viewer?.turn(!isStill);
  }
}

/**
 * Shows a coarse mesh of a model while the model is loading or not requested yet.
 * @param {Model} model @param {AbortSignal} signal
 * @returns {Promise<boolean>} whether it is shown
 */
async function putCoarse(model, signal) {
  try {
    const mesh = await readStl(await api.model(coarseUrl(model), signal));
    if (!signal.aborted) {
      put(mesh, true, true);
    }
    return !signal.aborted;
  } catch {
    return false;  // loading the model will report the problem
  }
}

/** Prepares for a model. @param {boolean} isFirst @returns {Promise<AbortSignal | null>} null if nothing can be drawn */
async function begin(isFirst) {
  loading.abort();
  loading = new AbortController();
  const {signal} = loading;
  marked = null;
  if (isFirst) {
    viewer?.clear();
  }
  note(text('view.loading'), {progress: 0});
  try {
    await awaitViewer();
    return signal;
  } catch {
    note(text('view.no-webgl'));
    return null;
  }
}

/** @param {Model} model @param {{isFirst?: boolean}} [growth]  isFirst: false for another model of the same object, which keeps the camera */
async function load(model, {isFirst = true} = {}) {
  const signal = await begin(isFirst);
  if (!signal) {
    return;
  }
  const isCoarse = isFirst && hasCoarse(model.bytes) && await putCoarse(model, signal);
  try {
    const mesh = await readStl(await api.model(model.url, signal), (progress) => note(text('view.loading'), {progress, isOver: isCoarse}));
    if (!signal.aborted) {
      put(mesh, isFirst && !isCoarse);
      note('');
      tools.putToolsAway();
      marked = [];
      markPlaces();
    }
  } catch (error) {
    if (!signal.aborted) {
      note(format.sentence(error instanceof Error ? error.message : String(error)), {button: text('view.retry')});
    }
  }
}

/** Shows a large model's coarse mesh, and offers to load the model. @param {Model} model */
async function offer(model) {
  const signal = await begin(true);
  const isOver = signal !== null && await putCoarse(model, signal);
  if (signal && !signal.aborted) {
    note(text('view.large'), {button: text('view.load', {bytes: format.bytes(model.bytes)}), isOver});
  }
}

/** @type {Stage['growing']} the preview that is shown or was requested last */
let grown = null;
/** @type {AbortController | null} of the request for the preview */
let growth = null;

/**
 * Shows the preview of a running scan. Only one mesh is requested at a time.
 * @param {NonNullable<Stage['growing']>} growing
 */
async function grow(growing) {
  const isFirst = grown?.url !== growing.url;
  if (growth || (!isFirst && grown?.snapshots === growing.snapshots)) {
    return;
  }
  grown = growing;
  growth = new AbortController();
  const {signal} = growth;
  try {
    await awaitViewer();
    const mesh = await readStl(await api.growing(growing.url, signal));
    if (!signal.aborted) {
      put(mesh, isFirst);
      if (isFirst) {
        note('');
      }
    }
  } catch {
    grown = isFirst ? null : grown;  // the next snapshot or the scan's end brings another mesh
  }
  if (!signal.aborted) {
    growth = null;
  }
}

/** @param {Stage} stage */
function setGrowing({growing, shows}) {
  if (growing && shows === 'model') {
    grow(growing);
  } else if (!growing) {
    growth?.abort();
    growth = null;
    grown = null;
  }
}

/** @param {Stage} stage */
function setModel({model, object: id}) {
  if ((model?.url ?? null) === current) {
    return;
  }
  const isFirst = current === null || id !== object || !model;
  current = model?.url ?? null;
  object = id;
  loading.abort();
  if (isFirst) {
    marked = null;
    viewer?.clear();
  }
  if (!model) {
    note('');
  } else if (loadsUnasked(model.bytes, isHandheld)) {
    load(model, {isFirst});
  } else {
    offer(model);
  }
}

/** @type {Model | null} */
let wanted = null;

/** @param {Stage} stage */
export function renderStage(stage) {
  wanted = stage.model;
  due = stage;
  element('stage').dataset.reachable = stage.isReachable ? 'yes' : 'no';
  element('stage').dataset.live = stage.isLive ? 'yes' : 'no';
  element('stage').dataset.hints = stage.hasHints ? 'yes' : 'no';
  element('stage').dataset.shows = stage.shows;
  show(element('stage-choice'), stage.hasChoice);
  pressed('show-model', stage.shows === 'model');
  pressed('show-camera', stage.shows === 'camera');
  show(element('camera'), stage.shows === 'camera');
  show(element('model'), stage.shows === 'model');
  const live = element('stage').dataset.sees === 'light' ? 'stage.light' : 'stage.live';
  setText(element('live-text'), stage.shows === 'model' ? stage.name :
      [text(stage.isScanning ? 'stage.scanning' : stage.isLive ? live : 'stage.none'), stage.sensor].filter(Boolean).join(' · '));
  setGrowing(stage);
  setModel(stage);
  markPlaces();
}

/** Paints the corners of a model if it is in view. @param {string} url @param {Uint8Array | null} colours  null: clay */
export const paintModel = (url, colours) => current === url && viewer?.paint(colours);

/** The picture of the model, as the address of a PNG; empty: there is none. */
export const modelPicture = () => viewer?.picture() ?? '';

/** Attaches the handler of the picture's button. */
export function prepareStage() {
  element('load-model').addEventListener('click', () => wanted && load(wanted));
}
