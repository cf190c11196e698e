// The first steps: check the scanner, calibrate, scan. They are hidden once all are done, or when they are dismissed.

import * as requests from '../api/api_calibration.js';
import {element, part, show} from '../base/dom.js';
import {here} from '../places.js';
import {note, noted} from '../base/storage.js';

const betweenLooks = 2000;  // milliseconds
const checkedKey = 'octurn-checked';
const demoTaken = '2026-11-25T05:01:47Z';  // the scan in demo.zip, which keeps its time when it is imported
const dismissedKey = 'octurn-first-steps-dismissed';

/** @typedef {import('../api/api.js').Scan} Scan */
/** @typedef {{isChecked: boolean, isCalibrated: boolean | null, hasModel: boolean | null, isDismissed: boolean}} Known  null: not known yet */

/**
 * The state of the first steps; null if they are hidden. Pure.
 * @param {Known} known
 * @returns {Record<'check' | 'calibrate' | 'scan', 'done' | 'now' | 'next'> | null}
 */
export function stepsOf({isChecked, isCalibrated: hasPose, hasModel, isDismissed}) {
  if (hasPose === null || hasModel === null || isDismissed || (hasPose && hasModel)) {
    return null;
  }
  const done = {check: isChecked || hasModel, calibrate: hasPose, scan: hasModel};
  const now = /** @type {const} */ (['check', 'calibrate', 'scan']).find((step) => !done[step]);
  const stateOf = (/** @type {keyof typeof done} */ step) => done[step] ? 'done' : step === now ? 'now' : 'next';
  return {check: stateOf('check'), calibrate: stateOf('calibrate'), scan: stateOf('scan')};
}

/** Whether a scan of this scanner has a model. The demo, opened in any browser, does not count. @param {Scan[]} scans */
export const hasFirstModel = (scans) => scans.some(({model, created}) => model !== null && created !== demoTaken);

/** @type {Known} */
const known = {isChecked: noted(checkedKey) !== null, isCalibrated: null, hasModel: null, isDismissed: noted(dismissedKey) !== null};

function render() {
  const steps = stepsOf(known);
  const list = element('first-steps');
  show(list, steps !== null);
  for (const [name, state] of Object.entries(steps ?? {})) {
    const step = part(list, `[data-step=${name}]`);
    step.dataset.state = state;
    step.toggleAttribute('aria-current', state === 'now');
    show(part(step, '.unseen'), state === 'done');
  }
}

/** @param {Scan[]} scans  all */
export function seeScans(scans) {
  known.hasModel = hasFirstModel(scans);
  render();
}

/** @param {import('../api/api.js').Report} report */
export function seeReport({state}) {
  if (state !== 'fault') {
    known.isChecked = true;
    note(checkedKey);
    render();
  }
}

function listen() {
  part(element('first-steps'), '[data-step=check] button').addEventListener('click', async () => {
    location.hash = 'scanner';
    (await import('./scanner_page.js')).check();
  });
  part(element('first-steps'), '[data-step=scan] button').addEventListener('click', () => element('start').focus());
  element('demo').addEventListener('click', async () => (await import('../scan/demo.js')).openDemo());
  element('dismiss-steps').addEventListener('click', () => {
    known.isDismissed = true;
    note(dismissedKey);
    render();
    element('panel').focus({preventScroll: true});
  });
}

/** Runs until the steps are done. */
export async function watchSteps() {
  listen();
  while (!known.isDismissed && !(known.isCalibrated && known.hasModel)) {
    if (here() === 'scan' && !document.hidden) {
      await requests.recentCalibration().then((calibration) => {
        known.isCalibrated = requests.isCalibrated(calibration);
        render();
      }, () => {});
    }
    await new Promise((done) => {
      setTimeout(done, betweenLooks);
    });
  }
}
