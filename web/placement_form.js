// The five numbers of the sensor's pose, each with a button for a little less and a little more.

import {degrees, millimetres} from './calibration.js';
import {copyOf, element, part, setText, show} from './dom.js';
import {differenceOf, placementOf, poseOf} from './pose.js';

/** @typedef {import('./pose.js').Matrix} Matrix */
/** @typedef {import('./pose.js').Placement} Placement */

/** @type {{key: keyof Placement, name: string, more: string, less: string, unit: string, step: number, digits: number}[]} */
const rows = [
  {key: 'x_mm', name: 'X', less: 'To the left', more: 'To the right', unit: 'mm', step: 1, digits: 1},
  {key: 'y_mm', name: 'Y', less: 'Away from the platform', more: 'Towards the platform', unit: 'mm', step: 1, digits: 1},
  {key: 'z_mm', name: 'Z', less: 'Lower', more: 'Higher', unit: 'mm', step: 1, digits: 1},
  {key: 'tilt_deg', name: 'Tilt', less: 'Look up', more: 'Look down', unit: '°', step: 0.1, digits: 2},
  {key: 'roll_deg', name: 'Roll', less: 'Roll to the left', more: 'Roll to the right', unit: '°', step: 0.1, digits: 2},
];

const names = {x_mm: 'X, sideways', y_mm: 'Y, from the axis', z_mm: 'Z, height', tilt_deg: 'Tilt, downwards', roll_deg: 'Roll'};

/** @type {Matrix | null} in force */
let inForce = null;
/** @type {Placement | null} as set by hand; null while it is the pose in force */
let draft = null;
/** @type {(pose: Matrix) => void} */
let onPose = () => {};

/** A length or angle with a minus sign that a field takes. @param {number} value @param {number} digits */
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
    setText(element('kept-text'), `Moves the axis by ${millimetres(shift_mm)}, the surface by ${millimetres(lift_mm)}; tilts both by ${degrees(tilt_deg)}.`);
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

/** Forgets what was set by hand. */
export function discard() {
  draft = null;
  fill();
  if (inForce) {
    onPose(inForce);
  }
}

/** @returns {Matrix | null} as set by hand, if it is */
export const chosenPose = () => draft && poseOf(draft);

/** @param {Matrix} pose  in force; what is set by hand meanwhile stays */
export function showPlacement(pose) {
  inForce = pose;
  if (!draft) {
    fill();
    onPose(pose);
  }
}

/** @param {typeof rows[number]} row */
function rowOf({key, name, less, more, unit, step, digits}) {
  const row = copyOf('placement-row');
  const field = part(row, 'input');
  field.id = `placement-${key}`;
  setText(part(row, 'label'), names[key]);
  part(row, 'label').htmlFor = field.id;
  setText(part(row, 'span'), unit);
  field.addEventListener('input', () => field.value !== '' && set(key, field.valueAsNumber));
  for (const button of row.querySelectorAll('button')) {
    const by = Number(button.dataset.by);
    button.setAttribute('aria-label', `${by < 0 ? less : more}, ${name}`);
    button.title = by < 0 ? less : more;
    button.addEventListener('click', (/** @type {MouseEvent} */ event) => {
      set(key, Number((field.valueAsNumber + by * step * (event.shiftKey ? 10 : 1)).toFixed(digits)));
    });
  }
  return row;
}

/**
 * @param {{onChange: (pose: Matrix) => void, onKeep: () => void}} events  onChange: with each step
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
