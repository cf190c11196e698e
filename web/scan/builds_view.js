// The models of a scan: their list, the running build, and the form "Build again".

import {element, list, part, setText, show} from '../base/dom.js';
import {fetchFragment} from '../base/fragment.js';
import {isEdited} from './builds.js';
import {planesOf} from './edits.js';
import {offerLeaves} from './leaf_choices.js';
import {explain, gap, threshold} from './settings.js';
import {text} from '../base/texts.js';

/** @typedef {ReturnType<import('./builds.js').buildsOf>} Builds */
/** @typedef {import('../api/api.js').Settings} Settings */

/**
 * @typedef {Object} Actions  handlers of the buttons
 * @property {(settings: Object) => void} build
 * @property {(build: number) => void} cancel
 * @property {(build: number) => void} show
 * @property {(build: number) => void} choose
 * @property {(build: number) => void} remove
 */

let isHere = false;  // whether the fragment is loaded
let isBegun = false;
/** @type {Builds | null} */
let last = null;
let filledFor = '';  // the scan
let filledWith = '';  // the settings in the form, of the model in view
let isTouched = false;  // whether somebody has changed them since
/** @type {import('./edits.js').Edits} of the model in view */
let edits = {};

const form = () => /** @type {HTMLFormElement} */ (element('build-form'));
const clipFields = () => /** @type {HTMLInputElement[]} */ ([...form().querySelectorAll('[data-clip]')])
    .sort((a, b) => Number(a.dataset.clip) - Number(b.dataset.clip));
const cropFields = () => /** @type {HTMLInputElement[]} */ ([...form().querySelectorAll('[data-crop]')])
    .sort((a, b) => Number(a.dataset.crop) - Number(b.dataset.crop));
const chosenMethod = () => part(element('build-methods'), 'input:checked').value;

function explainFields() {
  const method = chosenMethod();
  setText(element('build-method-text'), explain(method));
  setText(element('build-pose-text'), text(element('build-pose').value === 'auto' ?
    'builds.pose-auto-about' : 'builds.pose-stored-about'));
  for (const row of form().querySelectorAll('[data-of]')) {
    const isOf = /** @type {HTMLElement} */ (row).dataset.of === method;
    show(row, isOf);
    for (const field of row.querySelectorAll('input, select')) {
      /** @type {HTMLInputElement} */ (field).disabled = !isOf;
    }
  }
  const fields = clipFields();
  for (let axis = 0; axis < 3; ++axis) {
    const isEmpty = Number(fields[axis].value) >= Number(fields[axis + 3].value);
    fields[axis + 3].setCustomValidity(isEmpty ? text('clip.empty') : '');
  }
}

/**
 * @param {Settings & import('./edits.js').Edits & {max_error_mm?: number, parts?: string, level?: number | null}} settings
 */
function fill(settings) {
  edits = settings;
  element('build-scale').value = settings.scale ?? 1;
  element('build-triangles').value = settings.max_triangles ?? '';
  show(element('build-edits'), isEdited({...settings, scale: 1}));
  element('build-keep').checked = true;
  for (const field of cropFields()) {
    field.value = '';
  }
  offerLeaves(element('build-leaves'), settings.leaf_size_mm);
  for (const radio of form().querySelectorAll('[name=method]')) {
    /** @type {HTMLInputElement} */ (radio).checked = /** @type {HTMLInputElement} */ (radio).value === settings.method;
  }
  element('build-pose').value = settings.calibrate;
  element('build-error').value = settings.max_error_mm ?? 0.04;
  element('build-parts').value = settings.parts ?? 'main';
  element('build-gap').value = gap(settings.threshold_m2);
  element('build-level').value = settings.level ?? '';
  clipFields().forEach((field, index) => {
    field.value = String(settings.clip_mm[index]);
  });
  explainFields();
}

/** The form's settings, without those that the method does not use. */
function chosenSettings() {
  const method = chosenMethod();
  const {cut_mm = [], erase_mm = [], lay_mm = null} = element('build-keep').checked ? edits : {};
  const crop = planesOf(cropFields().map((field) => field.value === '' ? null : field.valueAsNumber));
  const own = method === 'solid' ? {
    max_triangles: element('build-triangles').value === '' ? null : element('build-triangles').valueAsNumber,
    cut_mm: [...cut_mm, ...crop],
    erase_mm,
    max_error_mm: element('build-error').valueAsNumber,
    parts: element('build-parts').value,
  } : {
    threshold_m2: threshold(element('build-gap').valueAsNumber),
    level: element('build-level').value === '' ? null : element('build-level').valueAsNumber,
  };
  return {
    method,
    leaf_size_mm: Number(part(element('build-leaves'), 'input:checked').value),
    calibrate: element('build-pose').value,
    clip_mm: clipFields().map((field) => field.valueAsNumber),
    scale: element('build-scale').valueAsNumber,
    lay_mm,
    ...own,
  };
}

/** @param {Builds} builds */
function showRows({rows}) {
  list(element('build-rows'), rows, ({number}) => String(number), 'build-row', (item, row) => {
    setText(part(item, '.build-name'), row.name);
    part(item, '.build-show').setAttribute('aria-pressed', String(row.isShown));
    show(part(item, '.badge'), row.badge !== null);
    setText(part(item, '.badge'), row.badge?.text ?? '');
    part(item, '.badge').dataset.tone = row.badge?.tone ?? '';
    setText(part(item, '.build-about'), `${row.about} · ${row.when}`);
    show(part(item, '.build-chosen'), row.isChosen);
    show(part(item, '[data-do=choose]'), !row.isChosen);
    show(part(item, '[data-do=remove]'), row.canRemove);
    part(item, '[data-do=download]').href = row.download;
    for (const action of item.querySelectorAll('[data-do=choose], [data-do=download], [data-do=remove]')) {
      action.setAttribute('aria-label', text('library.action', {action: action.title || text('builds.choose'), name: row.name}));
    }
  });
}

/** @param {Builds} builds */
function showGoing({going, trouble}) {
  show(element('build-going'), going !== null);
  setText(element('build-phase'), going?.text ?? '');
  const bar = element('build-progress');
  if (going?.share === null || going?.share === undefined) {
    bar.removeAttribute('value');  // indeterminate
  } else {
    bar.value = going.share;
  }
  show(element('build-trouble'), trouble !== null && going === null);
  setText(part(element('build-trouble'), 'strong'), trouble?.title ?? '');
  setText(part(element('build-trouble'), 'p'), trouble?.text ?? '');
}

/** @param {Builds | null} builds  of the scan in view */
export function renderBuilds(builds) {
  last = builds;
  show(element('builds'), Boolean(builds?.canBuild));
  show(element('cure'), Boolean(builds?.canBuild && builds.canStraighten && !builds.going));
  element('straighten').setAttribute('aria-disabled', String(Boolean(builds?.isBusy)));
  if (!builds?.canBuild || !isHere) {
    return;
  }
  if (filledFor !== builds.scan) {
    element('build-again').open = false;
  }
  const settings = JSON.stringify(builds.settings);
  if (filledFor !== builds.scan || filledWith !== settings && !isTouched) {
    fill(builds.settings);
    [filledFor, filledWith, isTouched] = [builds.scan, settings, false];
  }
  showRows(builds);
  showGoing(builds);
  element('build-start').setAttribute('aria-disabled', String(builds.isBusy));
}

/** @param {Actions} actions */
function listen(actions) {
  form().addEventListener('input', () => {
    isTouched = true;
    explainFields();
  });
  form().addEventListener('submit', (event) => {
    event.preventDefault();
    if (!last?.isBusy) {
      actions.build(chosenSettings());
    }
  });
  element('build-cancel').addEventListener('click', () => last?.going && actions.cancel(last.going.number));
  element('build-rows').addEventListener('click', (/** @type {any} */ event) => {
    const what = event.target.closest('[data-do]')?.dataset.do;
    const number = Number(event.target.closest('.build').dataset.key);
    if (what === 'show' || what === 'choose' || what === 'remove') {
      [filledWith, isTouched] = ['', false];  // the form follows the model that this brings into view
      actions[what](number);
    }
  });
}

/** Fetches the fragment, once. @param {Actions} actions */
export async function prepareBuilds(actions) {
  if (isBegun) {
    return;
  }
  isBegun = true;
  try {
    await fetchFragment(element('builds'), 'builds.html');
    isHere = true;
    listen(actions);
    renderBuilds(last);
  } catch {
    isBegun = false;  // retried at the next poll
  }
}
