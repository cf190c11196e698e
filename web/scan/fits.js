// The choice of a fit for a side of an object: candidate poses, or pairs of points. Pure.

import {millimetres, percent} from '../base/format.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api_poses.js').Pose} Pose */
/** @typedef {import('../api/api_poses.js').Candidate} Candidate */
/** @typedef {number[]} Point  x y z, millimetres */

/**
 * @typedef {Candidate & {candidate: number | null}} Fit  candidate: its index for the scanner; null: the model's fit, made from pairs
 *
 * @typedef {Object} Fits
 * @property {Fit[]} all  in the order in which they are shown
 * @property {number} used  index of the model's fit; -1: none
 * @property {number} shown
 * @property {Point[] | null} points  clicked points, alternately of the cloud seen before and of the side; null: a fit is shown
 */

export const wantedPairs = 3;

/** @param {Pose} pose @returns {Fits} */
export function fitsOf({registration}) {
  /** @type {Fit[]} */
  const all = (registration?.candidates ?? []).map((candidate, number) => ({...candidate, candidate: number}));
  if (!registration?.accepted) {
    return {all, used: -1, shown: 0, points: null};
  }
  const {object_from_platform, overlap, residual_mm, contradiction, candidate} = /** @type {Required<typeof registration>} */ (registration);
  const own = {object_from_platform, overlap, residual_mm, contradiction, candidate};
  if (candidate === null || !all[candidate]) {
    return {all: [own, ...all], used: 0, shown: 0, points: null};
  }
  return {all: all.map((fit, number) => number === candidate ? own : fit), used: candidate, shown: candidate, points: null};
}

/** Shows another fit. @param {Fits} fits @param {number} step  1: the next, -1: the previous @returns {Fits} */
export const withStep = (fits, step) => ({...fits, shown: Math.min(Math.max(fits.shown + step, 0), fits.all.length - 1)});

/** Starts setting pairs of points, or returns to the fits. @param {Fits} fits @param {boolean} areSet @returns {Fits} */
export const withPairs = (fits, areSet) => ({...fits, points: areSet ? [] : null});

/** Whether the next point is to be clicked on the side. @param {Fits} fits */
export const isOfSide = ({points}) => (points?.length ?? 0) % 2 === 1;

/** @param {Fits} fits @param {Point} point @returns {Fits} */
export const withPoint = (fits, point) => fits.points && fits.points.length < 2 * wantedPairs ? {...fits, points: [...fits.points, point]} : fits;

/** Removes the last point. @param {Fits} fits @returns {Fits} */
export const withoutPoint = (fits) => ({...fits, points: fits.points && fits.points.slice(0, -1)});

/** The choice to send to the scanner; null: not complete yet. @param {Fits} fits @returns {Object | null} */
export function choiceOf({all, used, shown, points}) {
  if (points) {
    return points.length < 2 * wantedPairs ? null :
      {pairs_mm: Array.from({length: wantedPairs}, (_, pair) => points.slice(2 * pair, 2 * pair + 2))};
  }
  const fit = all[shown];
  return !fit || shown === used || fit.candidate === null ? null : {candidate: fit.candidate};
}

/** @param {Fit} fit */
const figuresOf = ({overlap, residual_mm, contradiction}) => [
  text('fit.shares', {share: percent(overlap), distance: millimetres(residual_mm, 2)}),
  text('fit.contradicts', {share: percent(contradiction / 2)}),
].join('; ');

/** The description of what is shown. @param {Fits} fits @param {number} side */
export function textOf({all, used, shown, points}, side) {
  if (points) {
    const pair = Math.floor(points.length / 2) + 1;
    return pair > wantedPairs ? text('fit.pairs-set') :
      text(points.length % 2 === 0 ? 'fit.click-before' : 'fit.click-side', {pair, pairs: wantedPairs, side});
  }
  if (!all[shown]) {
    return text('fit.none');
  }
  const rest = shown === all.length - 1 ? ` ${text('fit.last')}` : '';
  return text(shown === used ? 'fit.in-model' : used < 0 ? 'fit.not-in-model' : 'fit.another',
      {fit: shown + 1, fits: all.length, figures: figuresOf(all[shown])}) + rest;
}

/** @param {Fits} fits */
export const choicesOf = (fits) => ({
  isWrong: !fits.points && fits.shown < fits.all.length - 1,
  isBack: fits.points ? true : fits.shown > 0,
  back: text(fits.points ? (fits.points.length > 0 ? 'undo' : 'fit.back-to-fits') : 'fit.back'),
  use: text(fits.points ? 'fit.use-pairs' : 'fit.use'),
  canUse: choiceOf(fits) !== null,
});
