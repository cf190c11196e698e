// The fields of the form "New scan".

import {element, part, setText} from './dom.js';
import {offerLeaves} from './leaf_choices.js';
import {explain, formOf, settingsOf, stepText} from './settings.js';

/** @typedef {import('./api.js').Settings} Settings */

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

/** Marks clip fields whose range is empty, so that the browser says so. */
function checkClip() {
  const fields = clipFields();
  for (let axis = 0; axis < 3; ++axis) {
    const isEmpty = Number(fields[axis].value) >= Number(fields[axis + 3].value);
    fields[axis + 3].setCustomValidity(isEmpty ? 'This must be more than where the space begins.' : '');
  }
}

/** @returns {Partial<Settings>} as the fields stand */
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

/**
 * Fills the form and makes it work.
 * @param {Settings} defaults
 */
export function prepareForm(defaults) {
  offerLeaves(element('leaves'), defaults.leaf_size_mm);
  fill(defaults);
  const form = element('form');
  form.addEventListener('input', (/** @type {InputEvent} */ event) => {
    if (event.target === element('snapshots-slider')) {
      element('snapshots').value = element('snapshots-slider').value;
    } else if (event.target === element('snapshots')) {
      element('snapshots-slider').value = element('snapshots').value;
    }
    explainFields();
    checkClip();
  });
  // A fault in a folded-away field can only be shown unfolded.
  form.addEventListener('invalid', (/** @type {Event} */ event) => {
    part(form, '.advanced').open ||= part(form, '.advanced').contains(event.target);
  }, true);
  element('defaults').addEventListener('click', () => {
    fill(defaults);
    checkClip();
  });
}
