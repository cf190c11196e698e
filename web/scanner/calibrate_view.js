// Renders a calibration on the page Calibrate, except the picture and the numbers of the pose.

import {isCalibrated} from '../api/api_calibration.js';
import * as texts from './calibration.js';
import {element, list, part, setText, show} from '../base/dom.js';
import {degrees, sentence} from '../base/format.js';
import {drawMap} from '../sensor/map_picture.js';
import {drawSlice} from '../sensor/plans.js';
import {reasonText} from '../base/wording.js';

/** @typedef {import('../api/api_calibration.js').Calibration} Calibration */

/** @param {string} id @param {{tone?: string, title: string, detail: string, hint?: string} | null} notice */
export function showNotice(id, notice) {
  show(element(id), notice !== null);
  if (notice) {
    element(id).dataset.tone = notice.tone ?? 'bad';
    setText(part(element(id), 'strong'), notice.title);
    setText(part(element(id), 'p'), notice.detail);
    const hint = part(element(id), '.hint');
    hint && setText(hint, notice.hint ?? '');
  }
}

/** Hides one of two elements and shows the other, and moves the focus along. @param {string} id @param {string} other */
function swap(id, other) {
  const hadFocus = element(id).contains(document.activeElement);
  show(element(id), false);
  show(element(other), true);
  if (hadFocus) {
    part(element(other), 'button').focus({preventScroll: true});
  }
}

/** @param {Calibration} calibration @param {'turn' | 'wall'} kind */
function showRun(calibration, kind) {
  const progress = texts.progressOf(calibration, kind);
  const idle = kind === 'turn' ? 'turn-idle' : 'wall-ready';
  progress ? swap(idle, `${kind}-going`) : swap(`${kind}-going`, idle);
  if (progress) {
    setText(element(`${kind}-text`), progress.text);
    element(`${kind}-progress`).value = progress.share;
  }
  showNotice(`${kind}-outcome`, texts.outcomeOf(calibration, kind));
}

/** @type {object | null} the report drawn last */
let drawn = null;

/** @param {import('../api/api_calibration.js').TurnReport} report */
function drawReport(report) {
  const slice = report.accepted && report.slice_mm;
  show(element('slices'), Boolean(slice));
  if (slice) {
    const all = [...slice.before, ...slice.after];
    drawSlice(element('slice-before'), slice.before, all, '#f4c95d');
    drawSlice(element('slice-after'), slice.after, all, '#74d3cb');
  }
  show(element('offsets'), report.stops.length > 0);
  const bars = texts.barsOf(report);
  for (const which of /** @type {const} */ (['usual', 'marked'])) {
    part(element('bars'), `[data-bars=${which}]`).setAttribute('d', bars[which]);
  }
  element('bars').setAttribute('aria-label', bars.label);
  setText(element('bars-up'), `+${degrees(texts.barRange(report.stops), 1)}`);
  setText(element('bars-down'), `−${degrees(texts.barRange(report.stops), 1)}`);
}

/** @param {Calibration} calibration */
function showReport({run}) {
  const report = texts.foundBy(run);
  show(element('found'), report !== null);
  if (!report) {
    drawn = null;
    return;
  }
  list(element('figures'), texts.figuresOf(report), ({label}) => label, 'fact', (item, {label, text}) => {
    setText(part(item, 'dt'), label);
    setText(part(item, 'dd'), text);
  });
  list(element('turn-findings'), report.findings, ({code, detail}) => `${code} ${detail}`, 'turn-finding', (item, found) => {
    setText(part(item, '.finding-name'), sentence(reasonText(found)));
    setText(part(item, '.finding-advice'), sentence(found.hint));
  });
  const mark = JSON.stringify(report);
  if (drawn !== mark) {
    drawn = mark;
    drawReport(report);
  }
}

/** @param {import('../sensor/map_picture.js').MapPicture | null} map */
export function showMap(map) {
  show(element('wall-picture'), map !== null);
  map && drawMap(element('wall-errors'), map);
}

/** @param {Calibration} calibration */
function showHistory(calibration) {
  const poses = texts.historyOf(calibration);
  show(element('no-poses'), poses.length === 0);
  setText(element('no-poses'), texts.noPosesText(calibration));
  show(element('undo'), poses.length > 0 || isCalibrated(calibration));  // the configured pose is the last that undo can restore
  list(element('poses'), poses, ({key}) => key, 'earlier-pose', (item, {title, text}) => {
    setText(part(item, '.pose-title'), title);
    setText(part(item, '.muted'), text);
  });
}

/** @param {Calibration} calibration */
export function showCalibration(calibration) {
  const summary = texts.summaryOf(calibration);
  const isNews = texts.outcomeOf(calibration, 'turn')?.tone === 'good';  // the outcome already says so
  showNotice('pose-summary', isNews ? null : {...summary, detail: summary.text});
  showRun(calibration, 'turn');
  showRun(calibration, 'wall');
  showReport(calibration);
  showHistory(calibration);
  setText(element('wall-map'), texts.mapText(calibration));
  setText(element('wall-warm'), texts.warmText(calibration.sensor_on_s));
  show(element('wall-simulated'), !element('simulated').hidden);
  show(element('forget-map'), calibration.sensor_map !== null && calibration.run?.state !== 'running');
  setText(element('optics'), texts.opticsText(calibration));
  show(element('optics'), calibration.optics !== null);
  show(element('undo-optics'), calibration.optics !== null && calibration.run?.state !== 'running');
  setText(element('scale-text'), texts.scaleText(calibration.scale));
  show(element('unscale'), calibration.scale !== 1);
}
