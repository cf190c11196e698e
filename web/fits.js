// How a side of an object fits to what was seen before: the poses to choose from, and pairs of points. Pure.

/** @typedef {import('./api_poses.js').Pose} Pose */
/** @typedef {import('./api_poses.js').Candidate} Candidate */
/** @typedef {number[]} Point  x y z, millimetres */

/**
 * @typedef {Candidate & {candidate: number | null}} Fit  candidate: its number for the scanner; null: the model has it, of pairs
 *
 * @typedef {Object} Fits
 * @property {Fit[]} all  to look at, one after the other
 * @property {number} used  that the model has; -1: none
 * @property {number} shown
 * @property {Point[] | null} points  that were clicked, first of what was seen before, then of the side, and so on; null: a fit is shown
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

/** Looks at another fit. @param {Fits} fits @param {number} step  1: the next, -1: the one before @returns {Fits} */
export const withStep = (fits, step) => ({...fits, shown: Math.min(Math.max(fits.shown + step, 0), fits.all.length - 1)});

/** Sets pairs of points, or goes back to the fits. @param {Fits} fits @param {boolean} areSet @returns {Fits} */
export const withPairs = (fits, areSet) => ({...fits, points: areSet ? [] : null});

/** Whether the next point is one of the side. @param {Fits} fits */
export const isOfSide = ({points}) => (points?.length ?? 0) % 2 === 1;

/** @param {Fits} fits @param {Point} point @returns {Fits} */
export const withPoint = (fits, point) => fits.points && fits.points.length < 2 * wantedPairs ? {...fits, points: [...fits.points, point]} : fits;

/** Takes the last point back. @param {Fits} fits @returns {Fits} */
export const withoutPoint = (fits) => ({...fits, points: fits.points && fits.points.slice(0, -1)});

/** What the scanner is asked for; null: nothing yet. @param {Fits} fits @returns {Object | null} */
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
  `${Math.round(100 * overlap)} % of this side lies on what was seen before, to ${residual_mm.toFixed(2)} mm`,
  `${Math.round(50 * contradiction)} % is where the other saw that nothing is`,
].join('; ');

/** What is shown, for people. @param {Fits} fits @param {number} side */
export function textOf({all, used, shown, points}, side) {
  if (points) {
    const pair = Math.floor(points.length / 2) + 1;
    return pair > wantedPairs ? 'Three pairs are set.' :
      points.length % 2 === 0 ? `Pair ${pair} of ${wantedPairs}: click a point of the left picture that the right one shows, too.` :
        `Pair ${pair} of ${wantedPairs}: click the same point of side ${side} on the right.`;
  }
  if (!all[shown]) {
    return 'No way to fit it is known. Set three pairs of points.';
  }
  const name = shown === used ? 'as in the model' : used < 0 ? 'not in the model' : 'another way';
  const rest = shown === all.length - 1 ? ' No further fit was found: if it looks wrong, set three pairs.' : '';
  return `Fit ${shown + 1} of ${all.length}, ${name}: ${figuresOf(all[shown])}.${rest}`;
}

/** @param {Fits} fits */
export const choicesOf = (fits) => ({
  isWrong: !fits.points && fits.shown < fits.all.length - 1,
  isBack: fits.points ? true : fits.shown > 0,
  back: fits.points ? (fits.points.length > 0 ? 'Undo' : 'Back to the fits') : 'Back',
  use: fits.points ? 'Fit by these pairs' : 'Use this fit',
  canUse: choiceOf(fits) !== null,
});
