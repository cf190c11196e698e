// The card with known lengths on the page Calibrate: lengths of a model beside those of its object, and how far the
// model is off.

import * as api from '../api/api.js';
import {builds} from '../api/api_builds.js';
import {copyOf, element, part, setText, show} from '../base/dom.js';
import {when} from '../base/format.js';
import {text} from '../base/texts.js';
import {readStl} from '../model/stl.js';
import {gaugeOf} from './calibration.js';

const maxLengths = 8;

/** @returns {HTMLElement[]} */
const rows = () => [...element('lengths').querySelectorAll('.length')];

/** The lengths in the form. @returns {import('./calibration.js').KnownLength[]} */
export const enteredLengths = () => rows().map((row) => ({
  model_mm: part(row, '.on-model').valueAsNumber,
  caliper_mm: part(row, '.by-caliper').valueAsNumber,
}));

function addLength() {
  const number = rows().length + 1;
  const row = copyOf('length-row');
  const labels = {'.on-model': 'calibrate.on-model-label', '.by-caliper': 'calibrate.by-caliper-label'};
  for (const [input, key] of Object.entries(labels)) {
    part(row, input).setAttribute('aria-label', number === 1 ? text(key) : `${text(key)} (${number})`);
    part(row, input).required = number === 1;
  }
  element('lengths').append(row);
  show(element('add-length'), number < maxLengths);
  return row;
}

function showErrors() {
  const gauge = gaugeOf(enteredLengths());
  rows().forEach((row, index) => setText(part(row, 'output'), gauge.off[index]));
  setText(element('gauge'), gauge.text);
}

/** Empties the form, down to one length. */
export function clearLengths() {
  rows().forEach((row) => row.remove());
  addLength();
  showErrors();
  setText(element('model-measured'), '');
}

/** Fills in the sizes of the newest model, if it is one of a block or a ball. */
async function measureModel() {
  const button = element('measure-model');
  button.disabled = true;
  setText(element('model-measured'), text('gauge.measuring'));
  try {
    const {gaugeSizes} = await import('../model/gauge.js');
    const newest = (await api.status()).newest ?? '';
    const {scale = 1} = (await builds(newest)).find(({chosen}) => chosen)?.settings ?? {};
    const {kind, sizes} = gaugeSizes(await readStl(await api.model(`scans/${newest}/Scan.stl`, new AbortController().signal)));
    if (sizes.length > 0) {
      clearLengths();
    }
    sizes.forEach((size, index) => {
      part(rows()[index] ?? addLength(), '.on-model').value = (size / scale).toFixed(2);
    });
    setText(element('model-measured'), text(`gauge.${kind}`));
  } catch {
    setText(element('model-measured'), text('gauge.no-model'));
  }
  button.disabled = false;
}

export function prepareLengths() {
  clearLengths();
  element('lengths').addEventListener('input', showErrors);
  element('measure-model').addEventListener('click', measureModel);
  element('add-length').addEventListener('click', () => part(addLength(), '.on-model').focus());
  element('print-lengths').addEventListener('click', () => {
    setText(element('gauge-when'), when(new Date().toISOString()));
    print();
  });
}
