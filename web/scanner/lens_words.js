// The texts on a camera's lens. Pure: the scanner's response in, texts and choices out.

import {millimetres, percent, sentence, when} from '../base/format.js';
import {fixed, text} from '../base/texts.js';
import {refusalText} from '../base/wording.js';

/** @typedef {import('../api/api_calibration.js').Calibration} Calibration */
/** @typedef {import('../api/api_calibration.js').LensReport} LensReport */
/** @typedef {import('../api/api_calibration.js').Lens} Lens */

const cells = 6;  // cells per side of the picture in the scanner's coverage
const parts = 3;  // parts per side of the picture that have names
const usualDistance = 300;  // mm from camera to object, at which errors are shown in mm

/** @param {Calibration} calibration */
export function keptText({lens, optics}) {
  if (!lens) {
    // A later turn or scan improves on what the board told.
    const byBoard = optics && [optics, ...optics.history].find(({source}) => source === 'board');
    return byBoard ? text('lens.kinect-kept', {when: when(byBoard.at)}) : text('lens.kinect-unknown');
  }
  const kept = lens.kept;
  return kept ? text('lens.kept', {when: when(kept.at), serial: kept.serial, rms: fixed(kept.rms_px, 2)}) : text('lens.configured');
}

/**
 * The part of the picture with the most missing cells, 0 to 8 by rows.
 * @param {number[]} coverage  1 for each cell that was seen
 */
export function missingPart(coverage) {
  const missing = new Array(parts * parts).fill(0);
  coverage.forEach((isSeen, cell) => {
    const row = Math.floor(Math.floor(cell / cells) * parts / cells);
    const column = Math.floor(cell % cells * parts / cells);
    missing[row * parts + column] += 1 - isSeen;
  });
  return missing.indexOf(Math.max(...missing));
}

/**
 * The progress of a running lens calibration, or null.
 * @param {Calibration | null} calibration
 * @returns {{advice: string, taken: string, share: number, canSolve: boolean} | null}
 */
export function lensProgressOf(calibration) {
  const run = calibration?.run;
  if (!run || run.kind !== 'lens' || run.state !== 'running') {
    return null;
  }
  if (run.phase === 'solving' || !run.look) {
    return {advice: text(run.phase === 'solving' ? 'lens.solving' : 'lens.opening'), taken: '', share: run.phase === 'solving' ? 0.98 : 0, canSolve: false};
  }
  const {advice, coverage} = run.look;
  const seen = coverage.filter(Boolean).length / coverage.length;
  return {
    advice: advice === 'reach' ? text('lens.reach', {part: text(`lens.part-${missingPart(coverage)}`)}) : text(`lens.do-${advice}`),
    taken: text('lens.taken', {taken: run.stop, wanted: run.stops, share: percent(seen, 0)}),
    share: 0.95 * Math.min(1, run.stop / Math.max(run.stops, 1), seen),
    canSolve: run.stop >= 5,
  };
}

/** @param {Calibration | null} calibration @returns {LensReport | null} an accepted lens that is neither kept nor discarded yet */
export function foundLens(calibration) {
  const run = calibration?.run;
  return run?.kind === 'lens' && run.state === 'done' ? /** @type {LensReport | null} */ (run.report) : null;
}

/** The reprojection error at the object's distance, mm. @param {LensReport} report */
const offAtObject = ({rms_px, lens}) => lens ? (rms_px ?? 0) * usualDistance / lens.fx : 0;

/**
 * The outcome of the last run, or null if there is none to show.
 * @param {Calibration | null} calibration
 * @returns {{tone: string, title: string, detail: string, hint: string} | null}
 */
export function lensOutcomeOf(calibration) {
  const run = calibration?.run;
  if (!run || run.kind !== 'lens' || run.state === 'running') {
    return null;
  }
  const found = foundLens(calibration);
  if (found?.optics) {
    const views = text('lens.pictures', {count: found.views});
    return {tone: 'good', title: text('lens.kinect-found'), hint: text('lens.kinect-found-hint'),
      detail: text('lens.kinect-found-about', {views, rms: fixed(found.rms_px ?? 0, 2)})};
  }
  if (found) {
    return {tone: 'good', title: text('lens.found'), hint: text('lens.found-hint'),
      detail: text('lens.found-about', {views: text('lens.pictures', {count: found.views}), rms: fixed(found.rms_px ?? 0, 2), off: millimetres(offAtObject(found))})};
  }
  if (run.state === 'cancelled') {
    return {tone: 'idle', title: text('run.cancelled'), detail: text('update.unchanged'), hint: ''};
  }
  if (run.state === 'refused') {
    const isKinect = !calibration.lens;
    return {tone: 'warn', title: text(isKinect ? 'lens.kinect-refused' : 'lens.refused'),
      detail: sentence(/** @type {LensReport} */ (run.report).reason),
      hint: text(isKinect ? 'lens.kinect-refused-hint' : 'lens.refused-hint')};
  }
  return {tone: 'bad', title: text('run.failed'), detail: sentence(run.error ? refusalText(run.error) : ''), hint: sentence(run.error?.hint ?? '')};
}

/** @param {LensReport} report @param {Lens} configured @returns {{label: string, text: string, configured: string}[]} */
export function lensFiguresOf({lens, sigma}, configured) {
  if (!lens || !sigma) {
    return [];
  }
  const row = (/** @type {string} */ label, /** @type {'fx' | 'fy' | 'cx' | 'cy' | 'k1' | 'k2'} */ key, /** @type {number} */ digits) => ({
    label, text: text('lens.figure', {value: fixed(lens[key], digits), sigma: fixed(sigma[key], digits)}), configured: text('lens.was-configured', {configured: fixed(configured[key], digits)}),
  });
  return [
    row(text('lens.focal-across'), 'fx', 2), row(text('lens.focal-down'), 'fy', 2), row(text('lens.axis-column'), 'cx', 2), row(text('lens.axis-row'), 'cy', 2),
    row('k1', 'k1', 4), row('k2', 'k2', 4),
  ];
}

/**
 * A Kinect's optics, as found.
 * @param {LensReport} report
 * @returns {{label: string, text: string, configured: string}[]}
 */
export function opticsFiguresOf({optics}) {
  if (!optics) {
    return [];
  }
  /** @type {[label: string, key: 'fx' | 'cx' | 'cy' | 'k1' | 'depth_scale', digits: number][]} */
  const rows = [
    [text('lens.focal'), 'fx', 2], [text('lens.axis-column'), 'cx', 2], [text('lens.axis-row'), 'cy', 2],
    ['k1', 'k1', 4], [text('lens.depth-scale'), 'depth_scale', 4],
  ];
  return rows.map(([label, key, digits]) => ({
    label,
    text: text('lens.figure', {value: fixed(optics[key], digits), sigma: fixed(optics.sigma[key], digits)}),
    configured: '',
  }));
}
