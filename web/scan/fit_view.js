// The dialog that lays a side's points over those seen before: to inspect the fit, choose another one, or set pairs of points.

import {posePoints} from '../api/api_poses.js';
import {element, setText, show} from '../base/dom.js';
import {choiceOf, choicesOf, fitsOf, isOfSide, textOf, withPairs, withPoint, withStep, withoutPoint} from './fits.js';
import * as format from '../base/format.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api_poses.js').Pose} Pose */
/** @typedef {import('./fits.js').Fits} Fits */

/** @type {import('../model/fit_viewer.js').FitViewer | null} */
let viewer = null;
/** @type {Fits} */
let fits = {all: [], used: -1, shown: 0, points: null};
let side = 2;

/** @param {Fits} next */
function change(next) {
  fits = next;
  const choices = choicesOf(fits);
  setText(element('fit-text'), textOf(fits, side));
  show(element('fit-wrong'), choices.isWrong);
  show(element('fit-back'), choices.isBack);
  setText(element('fit-back'), choices.back);
  show(element('fit-pairs'), !fits.points);
  show(element('fit-use'), choices.canUse);
  setText(element('fit-use'), choices.use);
  if (fits.points) {
    viewer?.showBeside(fits.points);
  } else if (fits.all[fits.shown]) {
    viewer?.showOver(fits.all[fits.shown].object_from_platform);
  } else {
    viewer?.showBeside([]);
  }
}

/** Steps back: removes the last point, leaves the pairs, or shows the previous fit. */
function back() {
  change(!fits.points ? withStep(fits, -1) : fits.points.length > 0 ? withoutPoint(fits) : withPairs(fits, false));
}

/** @param {string} scan @param {Pose} pose */
export async function openFit(scan, pose) {
  side = pose.pose + 1;
  setText(element('fit-title'), text('fit.title', {side}));
  setText(element('fit-side'), text('side', {side}));
  setText(element('fit-text'), text('fit.loading'));
  for (const id of ['fit-wrong', 'fit-back', 'fit-pairs', 'fit-use']) {
    show(element(id), false);
  }
  element('fit').showModal();
  try {
    const [{FitViewer}, points] = await Promise.all([import('../model/fit_viewer.js'), posePoints(scan, pose.pose)]);
    viewer ??= new FitViewer(element('fit-view'), (point, isSide) => isSide === isOfSide(fits) && change(withPoint(fits, point)));
    viewer.load(points);
    change(fitsOf(pose));
  } catch (error) {
    setText(element('fit-text'), format.sentence(error instanceof Error ? error.message : String(error)));
  }
}

/** Attaches the buttons' handlers. @param {(choice: Object) => void} choose */
export function prepareFit(choose) {
  const click = (/** @type {string} */ id, /** @type {() => void} */ action) => element(id).addEventListener('click', action);
  click('fit-wrong', () => change(withStep(fits, 1)));
  click('fit-back', back);
  click('fit-pairs', () => change(withPairs(fits, true)));
  click('fit-close', () => element('fit').close());
  click('fit-use', () => {
    const choice = choiceOf(fits);
    element('fit').close();
    if (choice) {
      choose(choice);
    }
  });
  element('fit').addEventListener('close', () => viewer?.clear());
}
