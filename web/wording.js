// What the scanner found, in the page's own words where it tells the values: reasons of a verdict, and why something was not
// done. A text's key has the code and the names of the values, which tell what a sentence of that code says. Whatever has
// none is said as the scanner says it.

import {degrees, leaf, millimetres, number, percent} from './format.js';
import {fixed, isText, text} from './texts.js';

/** @typedef {Record<string, number | string>} Parameters  by name, which ends with the unit */
/** @typedef {{code: string, detail: string, parameters?: Parameters}} Said */

/** @param {string} name @param {any} value */
function valueText(name, value) {
  const unit = name.slice(name.lastIndexOf('_') + 1);
  switch (unit) {
    case 'mm': return name.endsWith('leaf_size_mm') ? leaf(value) : millimetres(value, 1);
    case 'deg': return degrees(value, name === 'gap_deg' ? 0 : 1);
    case 'share': return percent(value, value < 0.1 ? 1 : 0);
    case 'mb': return `${number(value)} MB`;
    case 'disparity': return fixed(value, 2);
    case 'px': return number(Math.round(value));
    case 'triangles': return number(value);
    case 'cm3': return `${number(value)} cm³`;
    case 'ms': return `${number(value)} ms`;
    case 'side': return isText(`box-side.${value}`) ? text(`box-side.${value}`) : value;
    default: return value;
  }
}

/** @param {Parameters} parameters */
const shown = (parameters) => Object.fromEntries(Object.entries(parameters).map(([name, value]) => [name, valueText(name, value)]));

/** @param {string} code @param {Parameters} parameters */
const keyOf = (code, parameters) => [code, ...Object.keys(parameters).sort()].join('.');

/** Findings of a calibration that a verdict has under its own code. */
const sameAs = new Map([['stops-disagree.off_deg.stop', 'slip.off_deg.stop'],
  ['stops-disagree.turn_deg', 'turn-not-whole.turn_deg'], ['stops-disagree.stops', 'still.stops']]);

/** Why a model is not good, or what a calibration found. @param {Said} reason */
export function reasonText({code, detail, parameters = {}}) {
  const {object_side: side, ...own} = parameters;  // of a scan from several sides, which one it is about
  const said = keyOf(code, own);
  const key = sameAs.get(said) ?? said;
  if (!isText(`reason.${key}`)) {
    return detail;
  }
  const words = text(`reason.${key}`, shown(own));
  return side === undefined ? words : text('reason.of-side', {side, words});
}

/** Why something was not done. @param {Said} problem */
export function refusalText({code, detail, parameters = {}}) {
  const key = keyOf(code, parameters);
  return isText(`refusal.${key}`) ? text(`refusal.${key}`, shown(parameters)) : detail;
}
