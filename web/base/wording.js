// The page's own texts for messages of the scanner: reasons of a verdict, and refusals. A text's key consists of the message's code and
// the names of its parameters, which together identify the sentence. Without such a text the scanner's own sentence is shown.

import {degrees, disparity, leaf, millimetres, number, percent} from './format.js';
import {isText, text} from './texts.js';

/** @typedef {Record<string, number | string>} Parameters  by name; the name ends with the unit */
/** @typedef {{code: string, detail: string, parameters?: Parameters}} Said */

/** @param {string} name @param {any} value */
function valueText(name, value) {
  const unit = name.slice(name.lastIndexOf('_') + 1);
  switch (unit) {
    case 'mm': return name.endsWith('leaf_size_mm') ? leaf(value) : millimetres(value, 1);
    case 'deg': return degrees(value, name === 'gap_deg' ? 0 : 1);
    case 'share': return percent(value, value < 0.1 ? 1 : 0);
    case 'mb': return `${number(value)} MB`;
    case 'disparity': return disparity(value);
    case 'px': return number(Math.round(value));
    case 'triangles': return number(value);
    case 'cm3': return `${number(value)} cm³`;
    case 'min': return text('count.minutes', {count: value});
    case 'ms': return `${number(value)} ms`;
    case 'side': return isText(`box-side.${value}`) ? text(`box-side.${value}`) : value;
    default: return value;
  }
}

/** @param {Parameters} parameters */
const shown = (parameters) => Object.fromEntries(Object.entries(parameters).map(([name, value]) => [name, valueText(name, value)]));

/** @param {string} code @param {Parameters} parameters */
const keyOf = (code, parameters) => [code, ...Object.keys(parameters).sort()].join('.');

/** Findings of a calibration that have another code in a verdict. */
const turntable = new Map([
  ['off_deg.stop', 'slip.off_deg.stop'], ['turn_deg', 'turn-not-whole.turn_deg'], ['stops', 'still.stops']]);
const sameAs = new Map([
  ...['stops-disagree', 'turntable'].flatMap((code) => [...turntable].map(([names, key]) => [`${code}.${names}`, key])),
  ...['clockwise_deg.told_deg', 'told_deg.turned_deg'].map((names) => [`turn-ratio.${names}`, `turntable.${names}`]),
  ['turn-unknown', 'turntable'],
]);

/** The text of a verdict's reason or a calibration's finding. @param {Said} reason */
export function reasonText({code, detail, parameters = {}}) {
  const {object_side: side, ...own} = parameters;  // for a scan from several sides, the affected side
  const said = keyOf(code, own);
  const key = sameAs.get(said) ?? said;
  if (!isText(`reason.${key}`)) {
    return detail;
  }
  const words = text(`reason.${key}`, {...shown(own), count: Number(own.parts ?? 0)});
  return side === undefined ? words : text('reason.of-side', {side, words});
}

/** The text of a refusal. @param {Said} problem */
export function refusalText({code, detail, parameters = {}}) {
  const key = keyOf(code, parameters);
  return isText(`refusal.${key}`) ? text(`refusal.${key}`, shown(parameters)) : detail;
}
