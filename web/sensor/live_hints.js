// Hints on problems of a scan, from the analysis of the live picture (live_picture.js). Pure. Lengths are metres unless a
// name says millimetres.

import {centimetres} from '../base/format.js';
import {text} from '../base/texts.js';

/**
 * @typedef {import('./live_picture.js').Seen} Seen
 * @typedef {import('./live_picture.js').Rig} Rig
 * @typedef {import('./overlay.js').Sensor} Sensor
 * @typedef {{code: string, tone: 'good' | 'warn', text: string, detail: string}} Hint
 */

const limits = {
  read_share: 0.05,
  object: 40,           // pixels: a cube of 2 cm at 0.8 m has 60
  moved_share: 0.35,
  cut: 8,               // pixels
  beyond_share: 0.03,
  unread_share: 0.25,
};

/**
 * Problems for a scan by the texts hint.CODE, worst first.
 * @param {Omit<Seen, 'inside'>} seen @param {number} moved_share @param {Sensor} sensor @returns {[string, boolean][]}
 */
const troublesOf = (seen, moved_share, sensor) => [
  ['blind', seen.read_share < limits.read_share],
  ['moves', moved_share > limits.moved_share],
  ['empty', seen.object < limits.object],
  ['too-near', seen.nearest < sensor.nearest_m],
  ['cut-top', seen.cut.top > limits.cut],
  ['cut-side', seen.cut.side > limits.cut],
  ['turns-out', seen.beyond_share > limits.beyond_share],
  ['unread', seen.unread_share > limits.unread_share],
  ['too-far', seen.distance > sensor.farthest_m],
];

/** @param {Omit<Seen, 'inside'>} seen @param {number} moved_share @param {Pick<Rig, 'clip_mm' | 'sensor'>} rig @returns {Hint} */
export function hintOf(seen, moved_share, {clip_mm, sensor}) {
  const [code] = troublesOf(seen, moved_share, sensor).find(([, isSo]) => isSo) ?? [];
  if (code) {
    const values = {distance: centimetres(code === 'too-near' ? seen.nearest : seen.distance), height: centimetres(clip_mm[5] / 1000),
      least: centimetres(sensor.nearest_m), from: centimetres(sensor.best_m[0]), to: centimetres(sensor.best_m[1])};
    return {code, tone: 'warn', text: text(`hint.${code}`, values), detail: text(`hint.${code}-detail`, values)};
  }
  const [width, height] = [seen.width_mm, seen.height_mm].map((value) => centimetres(Math.max(0.01, value / 1000)));
  return {code: 'good', tone: 'good', text: text('hint.good'),
    detail: text('hint.good-detail', {width, height, distance: centimetres(seen.distance)})};
}

/**
 * Debounces hints: a hint is shown after two successive pictures with it, so that noise at a limit does not make it flicker.
 * @returns {(hint: Hint) => Hint | null} the hint to show after each picture
 */
export function steadyHint() {
  /** @type {Hint | null} */
  let shown = null;
  /** @type {string | null} */
  let last = null;
  return (hint) => {
    shown = hint.code === last || hint.code === shown?.code ? hint : shown;
    last = hint.code;
    return shown;
  };
}
