// "Check the scanner": runs the scanner's doctor, and shows its findings.

import * as api from '../api/api.js';
import {measure} from '../api/api_calibration.js';
import {turnStops} from './calibration.js';
import {element, list, part, setText, show} from '../base/dom.js';
import {capital, sentence} from '../base/format.js';
import {text, translated} from '../base/texts.js';

/** @typedef {import('../api/api.js').Finding} Finding */

// Order of the findings: worst first, unknown ones last.
const order = /** @type {const} */ (['fault', 'warning', 'ok', 'unknown']);

const expected = 4;  // usual seconds of a check, two of them to watch the sensor

/** The view of a report. Pure. @param {import('../api/api.js').Report} report */
export function shownOf({findings}) {
  const numberOf = (/** @type {Finding['state']} */ state) => findings.filter((finding) => finding.state === state).length;
  const faults = numberOf('fault') > 0 ? text('count.faults', {count: numberOf('fault')}) : '';
  const warnings = numberOf('warning') > 0 ? text('count.warnings', {count: numberOf('warning')}) : '';
  return {
    summary: faults && warnings ? text('check.found-both', {faults, warnings}) :
      faults || warnings ? text('check.found', {found: faults || warnings}) : text('check.good'),
    lines: order.flatMap((state) => findings.filter((finding) => finding.state === state)).map((finding) => ({
      key: finding.check,
      name: translated(finding.name),
      state: finding.state,
      stateName: text(`finding.${finding.state}`),
      measured: capital(translated(finding.measured)),
      advice: sentence(finding.advice),
      action: finding.action,
      actionName: finding.action && text(`action.${finding.action}`),
    })),
  };
}

/** The estimated progress of a check after some seconds; it approaches 1 but never reaches it. @param {number} seconds */
export const progressAfter = (seconds) => 1 - Math.exp(-1.5 * seconds / expected);

/** @param {ReturnType<typeof shownOf>} shown */
function showReport({summary, lines}) {
  setText(element('doctor-summary'), summary);
  list(element('findings'), lines, ({key}) => key, 'finding', (item, line) => {
    item.dataset.state = line.state;
    part(item, 'use').setAttribute('href', `icons/symbols.svg#${line.state}`);
    setText(part(item, '.finding-name'), line.name);
    setText(part(item, '.finding-state'), line.stateName);
    setText(part(item, '.finding-measured'), line.measured);
    setText(part(item, '.finding-advice'), line.advice);
    const button = part(item, 'button');
    button.dataset.action = line.action;
    setText(button, line.actionName);
    show(button, line.action !== '');
  });
}

/** @param {boolean} isRunning */
function showRunning(isRunning) {
  element('examine').setAttribute('aria-disabled', String(isRunning));  // unlike disabled, it keeps the focus
  show(element('doctor-progress'), isRunning);
  element('findings').classList.toggle('old', isRunning);
}

/** Moves the progress bar while a check runs. @returns {() => void} stops it */
function startProgress() {
  const begin = Date.now();
  const bar = element('doctor-progress');
  bar.value = 0;
  const timer = setInterval(() => {
    bar.value = progressAfter((Date.now() - begin) / 1000);
  }, 100);
  return () => clearInterval(timer);
}

const goTo = (/** @type {string} */ place) => {
  location.hash = place;
};

/** The actions of the findings' buttons. @type {Record<string, () => unknown>} */
const actions = {
  'measure-turn': async () => {
    await measure({kind: 'turn', stops: turnStops});
    goTo('calibrate');  // shows the progress
  },
  'set-pose': () => goTo('calibrate'),
  'open-settings': () => goTo('settings'),
  'choose-scans': () => goTo('library'),
};

/** @param {string} failure  text of the failed action @param {unknown} error */
function showProblem(failure, error) {
  const {title, detail, hint} = error instanceof api.Problem ? error : new api.Problem('page', String(error));
  setText(part(element('doctor-problem'), 'p'), [failure, detail || title, hint].filter(Boolean).map(sentence).join(' '));
  show(element('doctor-problem'), true);
}

/** @param {Event} event  a click on the findings */
async function carryOut({target}) {
  const {action} = /** @type {HTMLElement} */ (target).closest('button')?.dataset ?? {};
  if (!action) {
    return;
  }
  show(element('doctor-problem'), false);
  try {
    await actions[action]();
  } catch (error) {
    showProblem(text('failure.turn'), error);
  }
}

/** @param {(report: import('../api/api.js').Report) => void} onReport */
export async function examine(onReport) {
  if (element('examine').getAttribute('aria-disabled') === 'true') {
    return;
  }
  show(element('doctor-problem'), false);
  setText(element('doctor-summary'), text('check.running'));
  showRunning(true);
  const endProgress = startProgress();
  try {
    const report = await api.examine();
    showReport(shownOf(report));
    onReport(report);
  } catch (error) {
    setText(element('doctor-summary'), text('check.failed'));
    showProblem('', error);
  }
  endProgress();
  showRunning(false);
}

/** @param {(report: import('../api/api.js').Report) => void} onReport  called after each check */
export function prepareDoctor(onReport) {
  element('examine').addEventListener('click', () => examine(onReport));
  element('findings').addEventListener('click', carryOut);
}
