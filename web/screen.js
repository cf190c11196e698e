// What the page shows of what it knows. Pure: state in, texts and choices out. view.js puts them into the DOM.

import {asShown, buildShown, buildsOf, pictureUrl} from './builds.js';
import * as format from './format.js';
import {isPartOfAnother, posesOf} from './poses.js';
import {actionOf, badgeOf, verdictOf} from './quality.js';
import {isAway, running, scanOf} from './state.js';

/** @typedef {import('./state.js').State} State */
/** @typedef {import('./api.js').Scan} Scan */
/** @typedef {import('./api.js').Device} Device */
/** @typedef {'good' | 'busy' | 'warn' | 'bad' | 'idle'} Tone */

const methods = {solid: 'solid', intersection: 'by intersection'};

const filters = {'basic': 'unfiltered', 'average': 'average', 'average-discard': 'strict average'};

/** @type {Record<Scan['state'], {tone: Tone, text: string}>} */
const badges = {
  running: {tone: 'busy', text: 'Scanning'},
  paused: {tone: 'warn', text: 'Paused'},
  finished: {tone: 'good', text: 'Finished'},
  cancelled: {tone: 'idle', text: 'Cancelled'},
  failed: {tone: 'bad', text: 'Failed'},
  interrupted: {tone: 'warn', text: 'Interrupted'},
};

/** @param {Scan} scan */
export const nameOf = (scan) => scan.name || `Scan of ${format.when(scan.created)}`;

/** @param {Scan} scan */
const taken = (scan) => `${scan.snapshots_done} of ${scan.snapshots_total}`;

const phasesAfterTheTurn = new Set(['calibrating', 'rebuilding', 'registering', 'building', 'done']);

/** @param {Scan} scan */
function phaseText(scan) {
  const stop = `stop ${Math.min(scan.snapshots_done + 1, scan.snapshots_total)} of ${scan.snapshots_total}`;
  if (scan.error) {
    return `Trying ${stop} again`;
  }
  if (scan.snapshots_done === scan.snapshots_total && !phasesAfterTheTurn.has(scan.phase)) {
    return 'Looking once more at the first stop';
  }
  switch (scan.phase) {
    case 'starting': return 'Getting ready';
    case 'turning': return `Turning to ${stop}`;
    case 'capturing': return `Looking at ${stop}`;
    case 'calibrating': return 'Checking where the sensor stands';
    case 'rebuilding': return 'Building again, with the pose corrected';
    case 'registering': return 'Finding out how it was turned over';
    default: return 'Building the model';
  }
}

/** @param {Scan} scan */
const isBuilding = ({phase}) => phasesAfterTheTurn.has(phase);

/**
 * Building takes a moment after the last stop, so the last hundredths are its own.
 * @param {Scan} scan
 */
function percent(scan) {
  return scan.snapshots_total > 0 ? Math.floor(97 * scan.snapshots_done / scan.snapshots_total) : 0;
}

const steps = /** @type {const} */ (['ready', 'capture', 'build']);

/** @param {Scan} scan */
function stepStates(scan) {
  const now = scan.phase === 'starting' ? 0 : isBuilding(scan) ? 2 : 1;
  return steps.map((name, index) => ({name, state: index < now ? 'done' : index === now ? 'now' : 'next'}));
}

/** @param {Scan} scan */
const progressOf = (scan) => ({
  id: scan.id,
  phase: scan.phase,
  text: phaseText(scan),
  trouble: format.sentence(scan.error?.detail ?? ''),
  percent: percent(scan),
  done: scan.snapshots_done,
  total: scan.snapshots_total,
  left: format.timeLeft(scan.seconds_left),
  steps: stepStates(scan),
});

/** Why a scan has no model. @param {Scan} scan */
function troubleOf(scan) {
  const said = {
    detail: format.sentence(scan.error?.detail ?? ''),
    hint: format.sentence(scan.error?.hint ?? ''),
    action: actionOf(scan.error?.code),
  };
  switch (scan.state) {
    case 'cancelled':
      return {...said, tone: 'idle', title: 'Scan cancelled', detail: said.detail || 'It was stopped before the turn was complete.'};
    case 'paused':
      return {...said, tone: 'warn', title: 'Scan paused'};
    case 'interrupted':
      return {...said, tone: 'warn', title: 'Scan interrupted'};
    case 'failed':
      return {...said, tone: 'bad', title: 'Scan failed'};
    default:
      return null;
  }
}

/** @param {Scan} scan */
function poseFacts({calibration}) {
  if (!calibration) {
    return [];
  }
  const {accepted, confirms_told, solved, reason} = calibration;
  return [{label: 'Pose', text: !accepted || !solved ? `As it was: ${reason}` :
    `${confirms_told ? 'As it was, confirmed by this scan' : 'Found by this scan'}, looks agree to ${solved.after_mm.toFixed(2)} mm`}];
}

/** @param {Scan} scan @returns {{label: string, text: string, tone?: Tone}[]} */
function factsOf(scan) {
  const {model, settings} = scan;
  const took = scan.seconds_elapsed > 0 ? `, in ${format.duration(scan.seconds_elapsed)}` : '';
  const pictures = settings.filter === 'basic' ? '' : ` of ${settings.frames}`;
  const capture = [
    {label: 'Snapshots', text: `${taken(scan)}, ${filters[settings.filter]}${pictures}`},
    {label: 'Taken', text: `${format.when(scan.created)}${took}`},
    ...poseFacts(scan),
    ...(scan.late_pulses > 0 ? [{label: 'Motor', text: `${format.number(scan.late_pulses)} pulses late, so it turned more slowly`}] : []),
  ];
  if (!model) {
    return capture;
  }
  return [
    {label: 'Triangles', text: format.number(model.triangles)},
    model.watertight ? {label: 'Watertight', text: 'Yes'} : {label: 'Watertight', text: 'No, it has open edges', tone: 'warn'},
    ...(model.filled_share === null ? [] :
      [{label: 'Seen', text: `${Math.round(100 * (1 - model.filled_share))} % of the surface, the rest is filled in`}]),
    {label: 'Volume', text: `${format.number(model.volume_cm3)} cm³`},
    {label: 'Detail', text: `${format.number(settings.leaf_size_mm)} mm, ${methods[settings.method]}`},
    ...capture,
  ];
}

/**
 * What can be downloaded: the model, or, of a scan that has ended without one, that of the snapshots it has.
 * @param {Scan} scan
 */
function downloadOf({id, state, model, error, settings, ...scan}) {
  if (model) {
    return {url: model.url, about: format.bytes(model.bytes)};
  }
  const hasEnded = state === 'cancelled' || state === 'failed';
  return hasEnded && scan.snapshots_done > 0 && error?.code !== 'empty' ?
    {url: `/api/v1/scans/${id}/Scan.stl?leaf_size_mm=${settings.leaf_size_mm}`, about: `of ${scan.snapshots_done} ${scan.snapshots_done === 1 ? 'snapshot' : 'snapshots'}`} : null;
}

/**
 * The verdict, and which of its places are shown.
 * @param {State} state @param {Scan} scan  as it is shown
 */
function verdictShown(state, {model, calibration}) {
  const verdict = model && verdictOf(model, calibration?.findings);
  return verdict && {...verdict, reasons: verdict.reasons.map((reason) => ({...reason, isShown: reason.key === state.shownReason}))};
}

/** @param {State} state @param {Scan} scan  as it is shown */
const detailsOf = (state, scan) => ({
  id: scan.id,
  name: nameOf(scan),
  trouble: troubleOf(scan),
  verdict: verdictShown(state, scan),
  size: scan.model ? format.size(scan.model.size_mm) : '',
  facts: factsOf(scan),
  canResume: scan.state === 'paused' || scan.state === 'interrupted',
  download: downloadOf(scan),
});

/** @param {State} state */
const rowOf = (state) => (/** @type {Scan} */ scan) => ({
  id: scan.id,
  name: scan.name || 'Untitled scan',
  fullName: nameOf(scan),
  badge: scan.model && badgeOf(scan.model) || badges[scan.state],
  when: format.when(scan.created),
  about: scan.model ? `${format.size(scan.model.size_mm, 0)} · ${format.bytes(scan.model.bytes)}` :
    `${taken(scan)} snapshots${scan.state === 'running' ? '' : ' kept'}`,
  download: scan.model?.url ?? null,
  isCurrent: scan.id === (state.selected ?? running(state)?.id),
  isRunning: scan.state === 'running',
});

/** @param {string} role @param {Device} device */
function deviceOf(role, device) {
  const isReady = device.state === 'ready';
  const words = {unknown: 'being looked for', ready: 'ready', missing: 'not found', failed: 'failed'};
  return {
    role,
    tone: isReady ? 'good' : 'bad',
    name: device.name || role,
    text: words[device.state],
    message: isReady ? '' : format.sentence(device.message || `the ${role} is ${words[device.state]}`),
  };
}

/** @param {State} state */
function titleOf(state) {
  const scan = running(state);
  if (isAway(state)) {
    return 'No answer · Octurn';
  }
  if (scan) {
    return isBuilding(scan) ? 'Building · Octurn' : `${scan.snapshots_done}/${scan.snapshots_total} · Octurn`;
  }
  const shown = scanOf(state, state.selected);
  return shown ? `${shown.state === 'finished' ? 'Done' : badges[shown.state].text} · Octurn` : 'Octurn';
}

/**
 * For ears: one sentence a quarter of the turn, not one a stop.
 * @param {State} state
 */
function announcementOf(state) {
  const scan = running(state);
  if (scan) {
    const quarter = Math.floor(4 * scan.snapshots_done / Math.max(scan.snapshots_total, 1)) * 25;
    return isBuilding(scan) ? `${phaseText(scan)}.` :
      quarter === 0 ? `Scanning, ${scan.snapshots_total} snapshots.` : `${quarter} percent of the snapshots taken.`;
  }
  const shown = scanOf(state, state.selected);
  if (!shown?.model) {
    return shown ? `${troubleOf(shown)?.title ?? ''}.` : '';
  }
  const verdict = verdictOf(shown.model);
  return `The model of ${nameOf(shown)} is ready.${verdict && verdict.tone !== 'good' ? ` ${verdict.title}.` : ''}`;
}

/** @param {State} state */
export function screenOf(state) {
  const scan = running(state);
  const chosen = scanOf(state, state.selected);
  const panel = !state.status ? 'waiting' : chosen ? 'details' : scan ? 'progress' : 'form';
  const shown = chosen && asShown(state, chosen);
  const verdict = shown && verdictShown(state, shown);
  const hasModel = panel === 'details' && Boolean(shown?.model);
  const growing = panel === 'progress' && scan ? scan.preview : null;
  const has3D = hasModel || growing !== null;
  const devices = state.status ? [deviceOf('sensor', state.status.sensor), deviceOf('turntable', state.status.turntable)] : [];
  return {
    title: titleOf(state),
    announcement: announcementOf(state),
    isAway: isAway(state),
    isBusy: state.isPending,
    isSimulated: Boolean(state.status?.sensor.simulated || state.status?.turntable.simulated),
    devices,
    panel,
    progress: scan && progressOf(scan),
    details: shown && detailsOf(state, shown),
    builds: chosen && buildsOf(state, chosen),
    poses: chosen && posesOf(state, chosen),
    isScanElsewhere: panel === 'details' && scan !== null,
    problem: state.problem && {
      title: state.problem.title,
      detail: format.sentence(state.problem.detail),
      hint: format.sentence(state.problem.hint),
    },
    faults: panel === 'form' ? devices.map(({message}) => message).filter(Boolean) : [],
    stage: {
      shows: has3D ? state.stage : 'camera',
      hasChoice: has3D,
      model: hasModel && chosen && shown?.model ? {...shown.model, url: pictureUrl(chosen, buildShown(state, chosen))} : null,
      object: chosen?.id ?? '',
      places: verdict?.reasons.find(({isShown}) => isShown)?.places ?? [],
      growing,
      name: chosen ? nameOf(chosen) : growing ? 'Seen so far' : '',
      sensor: state.status?.sensor.name ?? '',
      isReachable: !isAway(state),
      isLive: state.status?.sensor.state === 'ready' && !isAway(state),
      isScanning: scan !== null,
    },
    rows: state.scans.filter((one) => !isPartOfAnother(one)).map(rowOf(state)),
    isListed: state.listed !== null,
    footer: state.status ? {version: `Octurn ${state.status.version}`, disk: `${format.bytes(state.status.disk_free_bytes)} free`} : null,
  };
}
