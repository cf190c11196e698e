// The fields of the form "New scan".

import {estimate} from '../api/api.js';
import {copyOf, element, part, setText} from '../base/dom.js';
import * as format from '../base/format.js';
import {offerLeaves} from './leaf_choices.js';
import {fromKept, presetOf, presets, toKept} from './presets.js';
import {explain, formOf, settingsOf, stepText} from './settings.js';
import {note, noted} from '../base/storage.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api.js').Settings} Settings */

const memory = 'octurn-scan';  // storage key of the last choice
const quietTime = 400;  // milliseconds from the last change until an estimate is requested

const clipFields = () => /** @type {HTMLInputElement[]} */ ([...element('form').querySelectorAll('[data-clip]')])
    .sort((a, b) => Number(a.dataset.clip) - Number(b.dataset.clip));

const chosenMethod = () => part(element('methods'), 'input:checked').value;

function explainFields() {
  const snapshots = Number(element('snapshots').value);
  setText(element('snapshots-step'), snapshots > 0 ? stepText(snapshots) : '');
  setText(element('method-text'), explain(chosenMethod()));
  setText(element('filter-text'), explain(element('filter').value));
  setText(element('calibrate-text'), explain(element('pose-of').value));
  element('gap').disabled = chosenMethod() === 'solid';
  element('frames').disabled = element('filter').value === 'basic';
}

/** @param {Settings} settings */
function fill(settings) {
  const form = formOf(settings);
  element('snapshots').value = form.snapshots;
  element('snapshots-slider').value = form.snapshots;
  element('filter').value = form.filter;
  element('frames').value = form.frames;
  element('gap').value = form.gap_mm;
  element('pose-of').value = form.calibrate;
  clipFields().forEach((field, index) => {
    field.value = String(form.clip_mm[index]);
  });
  for (const radio of element('methods').querySelectorAll('input')) {
    radio.checked = radio.value === form.method;
  }
  for (const radio of element('leaves').querySelectorAll('input')) {
    radio.checked = Number(radio.value) === form.leaf_size_mm;
  }
  explainFields();
}

/** @param {{seconds: number, bytes: number}} taken */
const takesText = ({seconds, bytes}) => `${format.roughly(seconds)}, ${format.bytes(bytes)}`;

/** @param {{memory_bytes?: number, fitting_leaf_size_mm?: number}} taken @param {number} leaf_size_mm */
const memoryText = ({memory_bytes = 0, fitting_leaf_size_mm = 0}, leaf_size_mm) => fitting_leaf_size_mm > leaf_size_mm ?
  text('form.memory', {bytes: format.bytes(memory_bytes), leaf: format.leaf(fitting_leaf_size_mm)}) : '';

/** @type {Map<string, ReturnType<typeof estimate>>} since the form came into view, by settings */
const estimates = new Map();

/** @param {Partial<Settings>} settings */
function estimateOf(settings) {
  const key = JSON.stringify(settings);
  const known = estimates.get(key) ?? estimate(settings);
  estimates.set(key, known);
  known.catch(() => estimates.delete(key));
  return known;
}

/** Shows the scan's estimated time and space, if the scanner can estimate them. */
async function tellEstimate() {
  if (!element('form').matches(':valid')) {
    return;
  }
  const chosen = chosenSettings();
  const text = await estimateOf(chosen).then((taken) => takesText(taken) + memoryText(taken, chosen.leaf_size_mm), () => '');
  setText(element('estimate'), text);
}

/** Shows each preset's estimated time and space. @param {Settings} defaults */
async function tellPresets(defaults) {
  for (const {name, settings} of presets(defaults)) {
    const taken = await estimateOf(formSettings(settings)).catch(() => null);
    setText(part(element('presets'), `[value=${name}] ~ .choice-mm`), taken ? format.roughly(taken.seconds) : '');
  }
}

/** The settings that a start accepts. @param {Settings} settings */
const formSettings = (settings) => settingsOf(formOf(settings));

/** @param {Settings} defaults */
function offerPresets(defaults) {
  element('presets').replaceChildren(...presets(defaults).map(({name}) => {
    const choice = copyOf('preset');
    part(choice, 'input').value = name;
    setText(part(choice, '.choice-name'), text(`preset.${name}`));
    return choice;
  }));
}

/** Selects the preset that equals the fields. @param {Settings} defaults */
function showPreset(defaults) {
  const chosen = chosenSettings();
  const preset = presetOf(chosen, defaults);
  for (const radio of element('presets').querySelectorAll('input')) {
    radio.checked = radio.value === preset?.name;
  }
  const {snapshots, leaf_size_mm} = chosen;
  const choice = text('form.choice', {count: snapshots ?? 0, leaf: format.leaf(leaf_size_mm ?? 0)});
  setText(element('preset-text'), preset ? choice : text('form.own', {choice}));
}

/** Marks clip fields with an empty range as invalid. */
function checkClip() {
  const fields = clipFields();
  for (let axis = 0; axis < 3; ++axis) {
    const isEmpty = Number(fields[axis].value) >= Number(fields[axis + 3].value);
    fields[axis + 3].setCustomValidity(isEmpty ? text('clip.empty') : '');
  }
}

/** @returns {Partial<Settings>} the fields' values */
export const chosenSettings = () => settingsOf({
  snapshots: Number(element('snapshots').value),
  method: chosenMethod(),
  leaf_size_mm: Number(part(element('leaves'), 'input:checked').value),
  filter: element('filter').value,
  frames: Number(element('frames').value),
  gap_mm: Number(element('gap').value),
  calibrate: element('pose-of').value,
  clip_mm: clipFields().map((field) => Number(field.value)),
});

/** The scanned space in the fields; null if it is incomplete. @returns {number[] | null} */
export function spaceChosen() {
  const clip_mm = clipFields().map((field) => field.valueAsNumber);
  return clip_mm.every(Number.isFinite) ? clip_mm : null;
}

/** Requests estimates whenever the form comes into view, as the last scan may have improved them. @param {Settings} defaults */
function watchForEstimates(defaults) {
  new IntersectionObserver((entries) => {
    if (entries.some(({isIntersecting}) => isIntersecting)) {
      estimates.clear();
      tellEstimate();
      tellPresets(defaults);
    }
  }).observe(element('start'));
}

/**
 * Fills the form and attaches its handlers.
 * @param {Settings} defaults
 */
export function prepareForm(defaults) {
  offerLeaves(element('leaves'), defaults.leaf_size_mm);
  offerPresets(defaults);
  fill(fromKept(noted(memory), defaults));
  const form = element('form');
  let timer = 0;
  const seeChange = () => {
    showPreset(defaults);
    note(memory, toKept(chosenSettings()));
    clearTimeout(timer);
    timer = setTimeout(tellEstimate, quietTime);
  };
  showPreset(defaults);
  watchForEstimates(defaults);
  form.addEventListener('input', (/** @type {any} */ event) => {
    const preset = presets(defaults).find(({name}) => event.target.name === 'preset' && name === event.target.value);
    if (preset) {
      fill(preset.settings);
    } else if (event.target === element('snapshots-slider')) {
      element('snapshots').value = element('snapshots-slider').value;
    } else if (event.target === element('snapshots')) {
      element('snapshots-slider').value = element('snapshots').value;
    }
    explainFields();
    checkClip();
    seeChange();
  });
  // The browser can show an invalid field only if its details element is open.
  form.addEventListener('invalid', (/** @type {Event} */ event) => {
    part(form, '.advanced').open ||= part(form, '.advanced').contains(event.target);
  }, true);
  element('defaults').addEventListener('click', () => {
    fill(defaults);
    checkClip();
    seeChange();
  });
}
