// What the page Calibrate says of a calibration. Pure: the scanner's answer in, texts and choices out.

import {count, sentence, when} from './format.js';

/** @typedef {import('./api_calibration.js').Calibration} Calibration */
/** @typedef {import('./api_calibration.js').PoseRecord} PoseRecord */
/** @typedef {import('./api_calibration.js').TurnReport} TurnReport */
/** @typedef {import('./api_calibration.js').WallReport} WallReport */
/** @typedef {import('./api_calibration.js').CalibrationRun} CalibrationRun */

const confirmed = {shift_mm: 0.1, tilt_deg: 0.05};  // less is no change: docs/calibration.md
export const turnStops = 24;  // of a turn that measures the pose
export const scaleLimits = {min: 0.97, max: 1.03};

/** @param {number} value  millimetres */
export const millimetres = (value) => `${value.toFixed(Math.abs(value) < 9.995 ? 2 : 1)} mm`;

/** @param {number} value */
export const degrees = (value) => `${value.toFixed(2)}°`;

const sources = {
  default: 'Taken from the drawing',
  settings: 'From the settings',
  page: 'Set by hand',
  turn: 'Measured with a turn',
  scan: 'Corrected by a scan',
};

/** @param {PoseRecord} pose */
export const sourceOf = ({source, at}) => at ? `${sources[source]}, ${when(at)}` : sources[source];

/** Whether anybody told where this sensor stands. @param {PoseRecord} pose */
const isTold = ({source}) => source !== 'default';

/** Whether that was found with this rig: by a turn, a scan, or on the page. @param {PoseRecord} pose */
export const isCalibrated = ({source}) => source === 'turn' || source === 'scan' || source === 'page';

/** @param {Calibration} calibration */
export function summaryOf(calibration) {
  if (!isTold(calibration)) {
    return {
      tone: 'warn',
      title: 'Not calibrated yet',
      text: 'The sensor is taken to stand exactly as in the drawing. On a real rig that is a few millimetres off, and models lose their thin parts.',
    };
  }
  const {sigma_mm, sigma_deg} = calibration;
  const text = sigma_mm !== null && sigma_deg !== null ?
    `The axis is known to ±${millimetres(sigma_mm)} and ±${degrees(sigma_deg)}.` : 'How exact it is, only a turn can tell.';
  return {tone: sigma_mm === null ? 'idle' : 'good', title: sourceOf(calibration), text};
}

/** @param {CalibrationRun} run */
function phaseOf({kind, phase, stop, stops}) {
  if (phase === 'solving') {
    return kind === 'wall' ? 'Working out the map' : 'Working out where the sensor stands';
  }
  return kind === 'wall' ? `Looking at the wall, ${stop} of ${stops}` : `Stop ${Math.min(stop + 1, stops)} of ${stops}`;
}

/** A turn or wall that is measured now, or null. @param {Calibration | null} calibration @param {CalibrationRun['kind']} kind */
export function progressOf(calibration, kind) {
  const run = calibration?.run;
  if (!run || run.kind !== kind || run.state !== 'running') {
    return null;
  }
  return {text: phaseOf(run), share: run.phase === 'solving' ? 0.95 : 0.92 * run.stop / Math.max(run.stops, 1)};
}

const hints = {
  turn: 'Put an object of 4 cm or more near the middle of the platform, keep hands and cables out of the picture, and measure again.',
  wall: 'Have the sensor look straight at a bare, matt wall that fills the whole picture, and look again.',
};

/** @param {TurnReport} report */
function acceptedText({shift_mm, tilt_deg, before_mm, after_mm}) {
  const [shift, tilt, before, after] = [shift_mm ?? 0, tilt_deg ?? 0, before_mm ?? 0, after_mm ?? 0];
  const agree = `Two looks at the object now agree to ${millimetres(after)}`;
  return shift <= confirmed.shift_mm && tilt <= confirmed.tilt_deg ?
    {title: 'The sensor stands where it was thought to stand', detail: `${agree}. Nothing was changed.`} :
    {title: `The axis was ${millimetres(shift)} and ${degrees(tilt)} off`, detail: `${agree}, before they were ${millimetres(before)} apart. The next scan uses the new pose.`};
}

/** @param {WallReport} report */
function flattenedText({rms_before, rms_after, walls}) {
  const [before, after] = [rms_before ?? 0, rms_after ?? 0];
  return {
    title: 'The sensor is flattened',
    detail: `It saw the wall uneven by ${before.toFixed(2)} steps of disparity, and sees it within ${after.toFixed(2)} now. The next scan uses the map. Measure the pose with a turn again.`,
    hint: walls.length > 1 ? '' : 'A second look from 0.85 to 0.95 m away tells how the error changes with distance, and makes the map better.',
  };
}

/**
 * What came of the last turn or wall, or null while there is nothing to say.
 * @param {Calibration | null} calibration @param {CalibrationRun['kind']} kind
 * @returns {{tone: string, title: string, detail: string, hint: string} | null}
 */
export function outcomeOf(calibration, kind) {
  const run = calibration?.run;
  if (!run || run.kind !== kind || run.state === 'running') {
    return null;
  }
  const detail = sentence(run.error?.detail || run.report?.reason || '');
  const hint = sentence(run.error?.hint || hints[kind]);
  switch (run.state) {
    case 'cancelled': return {tone: 'idle', title: 'Cancelled', detail: 'Nothing was changed.', hint: ''};
    case 'refused': return {tone: 'warn', title: 'Nothing was changed', detail, hint};
    case 'failed': return {tone: 'bad', title: 'The measurement did not end', detail, hint: sentence(run.error?.hint ?? '')};
    default:
      return run.report && (kind === 'turn' ? {tone: 'good', hint: '', ...acceptedText(/** @type {TurnReport} */ (run.report))} :
        {tone: 'good', ...flattenedText(/** @type {WallReport} */ (run.report))});
  }
}

/** What the last turn found, if it is worth a picture. @param {CalibrationRun | null} run @returns {TurnReport | null} */
export function foundBy(run) {
  const report = run?.kind === 'turn' && run.state !== 'running' ? /** @type {TurnReport | null} */ (run.report) : null;
  return report && (report.accepted || report.stops.length > 0 || report.findings.length > 0) ? report : null;
}

/** @param {TurnReport} report @returns {{label: string, text: string}[]} none where nothing was accepted */
export function figuresOf({accepted, shift_mm, tilt_deg, sigma_mm, sigma_deg, before_mm, after_mm}) {
  return !accepted ? [] : [
    ...(shift_mm === null ? [] : [{label: 'Axis moved', text: millimetres(shift_mm)}]),
    ...(tilt_deg === null ? [] : [{label: 'Axis tilted', text: degrees(tilt_deg)}]),
    ...(sigma_mm === null || sigma_deg === null ? [] : [{label: 'Known to', text: `±${millimetres(sigma_mm)}, ±${degrees(sigma_deg)}`}]),
    ...(before_mm === null || after_mm === null ? [] : [{label: 'Looks disagree', text: `${millimetres(before_mm)} → ${millimetres(after_mm)}`}]),
  ];
}

/** @param {Calibration} calibration */
export const historyOf = ({history}) => history.map((pose, index) => ({
  key: `${index} ${pose.at}`,
  title: sourceOf(pose),
  text: [
    pose.before_mm !== null && pose.after_mm !== null ? `${millimetres(pose.before_mm)} → ${millimetres(pose.after_mm)}` : '',
    pose.scale === 1 ? '' : `scale ${pose.scale.toFixed(4)}`].filter(Boolean).join(', '),
}));

/** What is said where there are none. @param {Calibration} calibration */
export const noPosesText = (calibration) => isCalibrated(calibration) ?
  'Before this one there was the pose of the settings.' : 'None yet. Each change can be undone here.';

/** @param {Calibration} calibration */
export const mapText = ({sensor_map: map}) => map ?
  `Done on ${when(map.at)} for sensor ${map.serial}: ${map.rms_before.toFixed(2)} → ${map.rms_after.toFixed(2)} steps of disparity.` :
  'Not done for this sensor.';

/** For how long the sensor has warmed up. @param {number | null} seconds */
export function warmText(seconds) {
  if (seconds === null) {
    return '';
  }
  const minutes = Math.floor(seconds / 60);
  const so = minutes < 1 ? 'for less than a minute' : `for ${count(minutes, 'minute')}`;
  return `It has been on ${so}${minutes < 10 ? '; this page keeps it on' : ''}.`;
}

/**
 * The scale that a length asks for, on top of the one that the model was made with.
 * @param {number} model_mm @param {number} caliper_mm @param {number} scale  in force
 * @returns {{scale: number, problem: string}}
 */
export function scaleOf(model_mm, caliper_mm, scale) {
  const wanted = Number((scale * caliper_mm / model_mm).toFixed(5));
  if (!(model_mm > 0 && caliper_mm > 0)) {
    return {scale, problem: 'Both lengths are needed.'};
  }
  const isFar = wanted < scaleLimits.min || wanted > scaleLimits.max;
  return {scale: wanted, problem: isFar ?
    `That would be ${(100 * Math.abs(wanted - 1)).toFixed(1)} %, more than a sensor can be off by. Look whether both are the same length.` : ''};
}

/** @param {number} scale */
export const scaleText = (scale) => scale === 1 ? 'Models have the size that the sensor tells.' :
  `Models are made ${(100 * Math.abs(scale - 1)).toFixed(2)} % ${scale > 1 ? 'larger' : 'smaller'} than the sensor tells.`;

/** How large the largest stop's offset is drawn, degrees. @param {TurnReport['stops']} stops */
export const barRange = (stops) => Math.max(0.5, ...stops.map(({off_deg}) => Math.abs(off_deg)));

/**
 * A bar for each stop: up where the platform had turned too far. SVG paths in a drawing of 100 x 100 with the middle at 50.
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
  return {usual: path(false), marked: path(true), label: `${count(stops.length, 'stop')}, the largest ${degrees(largest)} off`};
}
