// The numbers of the sensor's pose, each with buttons to decrease and increase it.

import {copyOf, element, part, setText, show} from '../base/dom.js';
import {degrees, millimetres} from '../base/format.js';
import {differenceOf, placementOf, poseOf} from '../base/pose.js';
import {text} from '../base/texts.js';

/** @typedef {import('../base/pose.js').Matrix} Matrix */
/** @typedef {import('../base/pose.js').Placement} Placement */

/** @type {{key: keyof Placement, name: string, unit: string, step: number, digits: number}[]}  name: of the texts placement.NAME */
const rows = [
  {key: 'x_mm', name: 'x', unit: 'mm', step: 1, digits: 1},
  {key: 'y_mm', name: 'y', unit: 'mm', step: 1, digits: 1},
  {key: 'z_mm', name: 'z', unit: 'mm', step: 1, digits: 1},
  {key: 'tilt_deg', name: 'tilt', unit: '°', step: 0.1, digits: 2},
  {key: 'roll_deg', name: 'roll', unit: '°', step: 0.1, digits: 2},
];

/** @type {Matrix | null} in force */
let inForce = null;
/** @type {Placement | null} as set by hand; null: unchanged */
let draft = null;
/** @type {(pose: Matrix) => void} */
let onPose = () => {};

/** A length or angle for a number field, without a negative zero. @param {number} value @param {number} digits */
const written = (value, digits) => (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits);

const fieldOf = (/** @type {string} */ key) => element(`placement-${key}`);

function fill() {
  const placement = draft ?? (inForce && placementOf(inForce));
  if (placement) {
    for (const {key, digits} of rows) {
      if (document.activeElement !== fieldOf(key) || !draft) {
        fieldOf(key).value = written(placement[key], digits);
      }
    }
  }
  show(element('kept'), draft !== null);
  if (draft && inForce) {
    const {shift_mm, lift_mm, tilt_deg} = differenceOf(inForce, poseOf(draft));
    setText(element('kept-text'), text('calibrate.kept', {shift: millimetres(shift_mm), lift: millimetres(lift_mm), tilt: degrees(tilt_deg)}));
  }
}

/** @param {keyof Placement} key @param {number} value */
function set(key, value) {
  if (inForce && Number.isFinite(value)) {
    draft = {...(draft ?? placementOf(inForce)), [key]: value};
    fill();
    onPose(poseOf(draft));
  }
}

/** Discards unsaved changes. */
export function discard() {
  draft = null;
  fill();
  if (inForce) {
    onPose(inForce);
  }
}

/** @returns {Matrix | null} the pose as set by hand; null: unchanged */
export const chosenPose = () => draft && poseOf(draft);

/** Shows the pose in force unless there are unsaved changes. @param {Matrix} pose */
export function showPlacement(pose) {
  inForce = pose;
  if (!draft) {
    fill();
    onPose(pose);
  }
}

/** @param {typeof rows[number]} row */
function rowOf({key, name, unit, step, digits}) {
  const row = copyOf('placement-row');
  const field = part(row, 'input');
  field.id = `placement-${key}`;
  setText(part(row, 'label'), text(`placement.${name}`));
  part(row, 'label').htmlFor = field.id;
  setText(part(row, 'span'), unit);
  field.addEventListener('input', () => field.value !== '' && set(key, field.valueAsNumber));
  for (const button of row.querySelectorAll('button')) {
    const by = Number(button.dataset.by);
    button.title = text(`placement.${name}-${by < 0 ? 'less' : 'more'}`);
    button.setAttribute('aria-label', button.title);
    button.addEventListener('click', (/** @type {MouseEvent} */ event) => {
      set(key, Number((field.valueAsNumber + by * step * (event.shiftKey ? 10 : 1)).toFixed(digits)));
    });
  }
  return row;
}

/**
 * @param {{onChange: (pose: Matrix) => void, onKeep: () => void}} events  onChange: called after each step
 */
export function preparePlacement({onChange, onKeep}) {
  onPose = onChange;
  element('placement').replaceChildren(...rows.map(rowOf));
  element('discard').addEventListener('click', discard);
  element('by-hand').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    onKeep();
  });
}
