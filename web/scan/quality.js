// The texts on a model's quality. Pure: the scanner's verdict in, texts and links out.

import {sentence} from '../base/format.js';
import {text} from '../base/texts.js';
import {reasonText} from '../base/wording.js';

/** @typedef {import('../api/api.js').Model} Model */

/** @typedef {import('../api/api.js').Reason} Reason */
/**
 * A link to a reason's remedy.
 * @typedef {{text: string, href: string, field?: string}} Action  field: of the form Build again
 */

const calibrate = {text: text('cure.calibrate'), href: '#calibrate'};
const space = {text: text('cure.space'), href: '#calibrate'};
const flatten = {text: text('cure.flatten'), href: '#calibrate'};
const wholeSpace = {text: text('cure.whole-space'), href: '#build-again', field: 'build-clip'};
const allParts = {text: text('cure.all-parts'), href: '#build-again', field: 'build-parts'};
const again = {text: text('cure.again'), href: '#'};
const testTurn = {text: text('cure.test-turn'), href: '#settings'};
const lowerSpace = {text: text('cure.lower-space'), href: '#build-again', field: 'build-clip'};
const solid = {text: text('cure.solid'), href: '#build-again', field: 'build-methods'};

/** @type {Record<string, Action>} */
const actions = {
  'stops-disagree': calibrate,
  'optics': calibrate,
  'floats': calibrate,
  'sunk': calibrate,
  'no-map': flatten,
  'cut-by-box': wholeSpace,
  'empty': again,
  'too-low': lowerSpace,
  'turntable': testTurn,
  'alike': calibrate,
  'top-unseen': again,
  'hollow-filled': again,
  'warm-up': flatten,
  'moved': again,
  'little-seen': again,
  'filled-far': again,
  'parts-dropped': allParts,
  'part-missing': calibrate,
  'swollen': solid,
  'large-file': solid,
  'coarser': space,
};

const saidByLink = new Set(['no-map', 'parts-dropped', 'cut-by-box', 'swollen', 'large-file']);

/** What to do about a reason; nothing where the link beside it says that. @param {Reason} reason */
const hintOf = ({code, hint}) => saidByLink.has(code ?? '') ? '' : sentence(hint);

/** Findings of a calibration that are not part of a verdict. */
const improvable = ['no-map', 'focal-length', 'wobble'];

/** @param {string | undefined} code @returns {Action | null} */
export const actionOf = (code) => actions[code ?? ''] ?? null;

const verdicts = {
  good: {tone: 'good', icon: 'ok'},
  look: {tone: 'warn', icon: 'warning'},
  bad: {tone: 'bad', icon: 'fault'},
};

/** @param {Model} model @returns {{tone: string, text: string} | null} null for a model without a verdict */
export const badgeOf = ({quality}) => quality ? {tone: verdicts[quality.verdict].tone, text: text(`verdict.${quality.verdict}-short`)} : null;

/**
 * @param {Model} model
 * @param {Reason[]} findings  of the scan's calibration; some do not affect the verdict but could improve the next model
 */
export function verdictOf({quality, watertight}, findings = []) {
  if (!quality) {
    return null;
  }
  const {tone, icon} = verdicts[quality.verdict];
  return {
    tone,
    icon,
    title: text(`verdict.${quality.verdict}`),
    text: quality.verdict !== 'good' ? '' :
      text(watertight ? 'verdict.good-about' : 'verdict.open'),
    reasons: [...quality.reasons, ...findings.filter(({code}) => improvable.includes(code ?? ''))].map((reason) => ({
      key: `${reason.code} ${reason.detail}`,
      detail: sentence(reasonText(reason)),
      hint: hintOf(reason),
      action: actionOf(reason.code),
      places: reason.places_mm ?? [],
    })),
  };
}
