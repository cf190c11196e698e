// The texts of the page Calibrate. Pure: the scanner's response in, texts and choices out.

import {isCalibrated} from '../api/api_calibration.js';
import {degrees, disparity, millimetres, percent, sentence, when} from '../base/format.js';
import {fixed, text} from '../base/texts.js';
import {refusalText} from '../base/wording.js';

/** @typedef {import('../api/api_calibration.js').Calibration} Calibration */
/** @typedef {import('../api/api_calibration.js').PoseRecord} PoseRecord */
/** @typedef {import('../api/api_calibration.js').TurnReport} TurnReport */
/** @typedef {import('../api/api_calibration.js').WallReport} WallReport */
/** @typedef {import('../api/api_calibration.js').CalibrationRun} CalibrationRun */

const confirmed = {shift_mm: 0.1, tilt_deg: 0.05};  // smaller changes count as none: docs/calibration.md
export const turnStops = 24;  // stops of a calibration turn
export const scaleLimits = {min: 0.9, max: 1.1};

/** @param {PoseRecord} pose */
export const sourceOf = ({source, at}) => at ? text('pose.at', {source: text(`pose.${source}`), when: when(at)}) : text(`pose.${source}`);

/** Whether the sensor's pose is configured. @param {PoseRecord} pose */
const isTold = ({source}) => source !== 'default';

/** @param {Calibration} calibration */
export function summaryOf(calibration) {
  if (calibration.lens && calibration.sigma_mm === null) {
    return {tone: 'idle', title: text('lens.rig'), text: text('lens.rig-about')};
  }
  if (!isTold(calibration)) {
    return {
      tone: 'warn',
      title: text('pose.untold'),
      text: text('pose.untold-about'),
    };
  }
  const {sigma_mm, sigma_deg} = calibration;
  return {tone: sigma_mm === null ? 'idle' : 'good', title: sourceOf(calibration), text: sigma_mm !== null && sigma_deg !== null ?
    text('pose.known', {shift: millimetres(sigma_mm), tilt: degrees(sigma_deg)}) : text('pose.unknown')};
}

/** @param {CalibrationRun} run */
function phaseOf({kind, phase, stop, stops}) {
  if (phase === 'solving') {
    return text(`run.solving-${kind}`);
  }
  return text(`run.${kind}`, {stop: kind === 'wall' ? stop : Math.min(stop + 1, stops), stops});
}

/** The progress of a running measurement of that kind, or null. @param {Calibration | null} calibration @param {CalibrationRun['kind']} kind */
export function progressOf(calibration, kind) {
  const run = calibration?.run;
  if (!run || run.kind !== kind || run.state !== 'running') {
    return null;
  }
  return {text: phaseOf(run), share: run.phase === 'solving' ? 0.95 : 0.92 * run.stop / Math.max(run.stops, 1)};
}

/** @param {TurnReport} report */
function acceptedText({shift_mm, tilt_deg, before_mm, after_mm, confirms_told}) {
  const [shift, tilt, before, after] = [shift_mm ?? 0, tilt_deg ?? 0, before_mm ?? 0, after_mm ?? 0];
  const values = {shift: millimetres(shift), tilt: degrees(tilt), before: millimetres(before), after: millimetres(after)};
  const outcome = confirms_told ?? (shift <= confirmed.shift_mm && tilt <= confirmed.tilt_deg) ? 'confirmed' : 'moved';
  const title = confirms_told === false ? 'run.lasers' : `run.${outcome}`;  // the lasers changed; the camera's pose may be unchanged
  return {title: text(title, values), detail: text(`run.${outcome}-about`, values)};
}

/** @param {WallReport} report */
function flattenedText({rms_before, rms_after, walls}) {
  const [before, after] = [rms_before ?? 0, rms_after ?? 0];
  return {
    title: text('run.flattened'),
    detail: text('run.flattened-about', {before: disparity(before), after: disparity(after)}),
    hint: walls.length > 1 ? '' : text('run.flattened-hint'),
  };
}

/**
 * The outcome of the last measurement of that kind, or null if there is none to show.
 * @param {Calibration | null} calibration @param {CalibrationRun['kind']} kind
 * @returns {{tone: string, title: string, detail: string, hint: string} | null}
 */
export function outcomeOf(calibration, kind) {
  const run = calibration?.run;
  if (!run || run.kind !== kind || run.state === 'running') {
    return null;
  }
  const detail = sentence(run.error ? refusalText(run.error) : run.report?.reason ?? '');
  const hint = run.error?.hint ? sentence(run.error.hint) : text(`run.${kind}-hint`);
  switch (run.state) {
    case 'cancelled': return {tone: 'idle', title: text('run.cancelled'), detail: text('update.unchanged'), hint: ''};
    case 'refused': return {tone: 'warn', title: text('run.unchanged'), detail, hint};
    case 'failed': return {tone: 'bad', title: text('run.failed'), detail, hint: sentence(run.error?.hint ?? '')};
    default:
      return run.report && (kind === 'turn' ? {tone: 'good', hint: '', ...acceptedText(/** @type {TurnReport} */ (run.report))} :
        {tone: 'good', ...flattenedText(/** @type {WallReport} */ (run.report))});
  }
}

/** The last turn's report, if there is something to draw. @param {CalibrationRun | null} run @returns {TurnReport | null} */
export function foundBy(run) {
  const report = run?.kind === 'turn' && run.state !== 'running' ? /** @type {TurnReport | null} */ (run.report) : null;
  return report && (report.accepted || report.stops.length > 0 || report.findings.length > 0) ? report : null;
}

/** @param {TurnReport} report @returns {{label: string, text: string}[]} empty unless it was accepted */
export function figuresOf({accepted, shift_mm, tilt_deg, sigma_mm, sigma_deg, before_mm, after_mm}) {
  return !accepted ? [] : [
    ...(shift_mm === null ? [] : [{label: text('figure.moved'), text: millimetres(shift_mm)}]),
    ...(tilt_deg === null ? [] : [{label: text('figure.tilted'), text: degrees(tilt_deg)}]),
    ...(sigma_mm === null || sigma_deg === null ? [] : [{label: text('figure.known'), text: `±${millimetres(sigma_mm)}, ±${degrees(sigma_deg)}`}]),
    ...(before_mm === null || after_mm === null ? [] : [{label: text('figure.disagree'), text: `${millimetres(before_mm)} → ${millimetres(after_mm)}`}]),
  ];
}

/** @param {Calibration} calibration */
export const historyOf = ({history}) => history.map((pose, index) => ({
  key: `${index} ${pose.at}`,
  title: sourceOf(pose),
  text: [
    pose.before_mm !== null && pose.after_mm !== null ? `${millimetres(pose.before_mm)} → ${millimetres(pose.after_mm)}` : '',
    pose.scale === 1 ? '' : text('pose.scale', {scale: fixed(pose.scale, 4)})].filter(Boolean).join(', '),
}));

/** The text for an empty history. @param {Calibration} calibration */
export const noPosesText = (calibration) => text(isCalibrated(calibration) ? 'pose.none-before' : 'pose.none');

/** @param {Calibration} calibration */
export const mapText = ({sensor_map: map}) => map ?
  text('map.done', {when: when(map.at), serial: map.serial,
    before: disparity(map.rms_before), after: disparity(map.rms_after)}) : text('map.none');

/** The measured optics in force, in words; empty without any. @param {Calibration} calibration */
export const opticsText = ({optics}) => optics ? text('optics.known', {when: when(optics.at), source: text(`optics.${optics.source}`),
  focal: fixed(optics.fx, 1), focalSigma: fixed(optics.sigma.fx, 1), x: fixed(optics.cx, 1), y: fixed(optics.cy, 1), sigma: fixed(optics.sigma.cx, 1)}) : '';

/** The sensor's warm-up time so far, in words. @param {number | null} seconds */
export function warmText(seconds) {
  if (seconds === null) {
    return '';
  }
  const minutes = Math.floor(seconds / 60);
  return text(minutes < 1 ? 'warm.less' : minutes < 10 ? 'warm.short' : 'warm.on', {minutes: text('count.minutes', {count: minutes})});
}

/** @typedef {{model_mm: number, caliper_mm: number}} KnownLength  of a model, and of its object; NaN: not entered */

/** @param {KnownLength} length */
const isEntered = ({model_mm, caliper_mm}) => model_mm > 0 && caliper_mm > 0;

/** @param {KnownLength} length */
const isEmpty = ({model_mm, caliper_mm}) => Number.isNaN(model_mm) && Number.isNaN(caliper_mm);

/**
 * The factor that fits models to their objects: least squares of the lengths' errors.
 * @param {KnownLength[]} lengths  entered ones
 */
const factorOf = (lengths) => lengths.reduce((sum, {model_mm, caliper_mm}) => sum + model_mm * caliper_mm, 0) /
  lengths.reduce((sum, {model_mm}) => sum + model_mm * model_mm, 0);

/**
 * The scale from known lengths, combined with the scale with which the model was made.
 * @param {KnownLength[]} lengths  rows without any number are left out @param {number} scale  in force
 * @returns {{scale: number, problem: string}}
 */
export function scaleOf(lengths, scale) {
  const entered = lengths.filter(isEntered);
  const isHalf = lengths.some((length) => !isEntered(length) && !isEmpty(length));
  if (entered.length === 0 || isHalf) {
    return {scale, problem: text('scale.both')};
  }
  const wanted = Number((scale * factorOf(entered)).toFixed(5));
  const isFar = wanted < scaleLimits.min || wanted > scaleLimits.max;
  return {scale: wanted, problem: isFar ? text('scale.far', {share: percent(Math.abs(wanted - 1), 1)}) : ''};
}

/**
 * How exact a model is, by known lengths.
 * @param {KnownLength[]} lengths
 * @returns {{off: string[], text: string}}  the error of each, and all of them in words; empty where nothing is entered
 */
export function gaugeOf(lengths) {
  const signed = (/** @type {number} */ error) => `${error < 0 ? '−' : '+'}${millimetres(Math.abs(error), 2)}`;
  const off = lengths.map((length) => isEntered(length) ? signed(length.model_mm - length.caliper_mm) : '');
  const entered = lengths.filter(isEntered);
  if (entered.length === 0) {
    return {off, text: ''};
  }
  const described = (/** @type {number} */ factor) => {
    const errors = entered.map(({model_mm, caliper_mm}) => Math.abs(factor * model_mm - caliper_mm));
    const mean = errors.reduce((sum, error) => sum + error, 0) / errors.length;
    return {mean: millimetres(mean, 2), worst: millimetres(Math.max(...errors), 2)};
  };
  const now = described(1);
  const {mean: meanScaled, worst: worstScaled} = described(factorOf(entered));
  return {off, text: text(entered.length === 1 ? 'gauge.one' : 'gauge.all', {...now, meanScaled, worstScaled})};
}

/** @param {number} scale */
export const scaleText = (scale) => scale === 1 ? text('scale.none') :
  text(scale > 1 ? 'scale.larger' : 'scale.smaller', {share: percent(Math.abs(scale - 1), 2)});

/** The range of the bars, degrees: the largest offset, at least 0.5. @param {TurnReport['stops']} stops */
export const barRange = (stops) => Math.max(0.5, ...stops.map(({off_deg}) => Math.abs(off_deg)));

/**
 * A bar for each stop, upwards if the platform had turned too far. SVG paths in a view box of 100 x 100, with zero at 50.
 * @param {TurnReport} report @returns {{usual: string, marked: string, label: string}}
 */
export function barsOf({stops, findings}) {
  const named = new Set(findings.map(({stop}) => stop));
  const range = barRange(stops);
  const bar = (/** @type {number} */ index) => {
    const left = 100 * (index + 0.18) / stops.length;
    const tip = 50 - 46 * stops[index].off_deg / range;
    return `M${left.toFixed(2)} 50V${(Math.abs(tip - 50) < 0.6 ? 49.4 : tip).toFixed(2)}h${(64 / stops.length).toFixed(2)}V50Z`;
  };
  const path = (/** @type {boolean} */ isNamed) => stops.map((_, index) => named.has(index) === isNamed ? bar(index) : '').join('');
  const largest = Math.max(0, ...stops.map(({off_deg}) => Math.abs(off_deg)));
  return {usual: path(false), marked: path(true), label: text('calibrate.angles-spoken', {stops: text('count.stops', {count: stops.length}), angle: degrees(largest)})};
}
