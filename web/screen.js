// The page's view model. Pure: state in, texts and choices out. view.js renders them.

import {asShown, buildShown, buildsOf, isBuildBusy, isGoing, pictureUrl, runOf} from './scan/builds.js';
import * as format from './base/format.js';
import {found, knownTags, pictureOf} from './library/library.js';
import {isPartOfAnother, posesOf} from './scan/poses.js';
import {isBuilding, phaseText, progressOf} from './scan/progress.js';
import {actionOf, badgeOf, verdictOf} from './scan/quality.js';
import {isAway, running, scanOf, unfinished} from './state.js';
import {text, translated} from './base/texts.js';
import {refusalText} from './base/wording.js';

/** @typedef {import('./state.js').State} State */
/** @typedef {import('./api/api.js').Scan} Scan */
/** @typedef {import('./api/api.js').Model} Model */
/** @typedef {import('./api/api.js').Device} Device */
/** @typedef {'good' | 'busy' | 'warn' | 'bad' | 'idle'} Tone */

/** @type {Record<Scan['state'], Tone>} */
const tones = {running: 'busy', paused: 'warn', finished: 'good', cancelled: 'idle', failed: 'bad', interrupted: 'warn'};

/** @param {Scan} scan */
export const nameOf = (scan) => scan.name || text('scan.unnamed', {when: format.when(scan.created)});

/** @param {Pick<Scan, 'snapshots_done' | 'snapshots_total'>} scan */
const taken = (scan) => text('count.of', {done: scan.snapshots_done, total: scan.snapshots_total});

/** Why a scan has no model. @param {Scan} scan */
function troubleOf(scan) {
  const said = {
    detail: scan.error ? format.sentence(refusalText(scan.error)) : '',
    hint: format.sentence(scan.error?.hint ?? ''),
    action: actionOf(scan.error?.code),
  };
  switch (scan.state) {
    case 'cancelled':
      return {...said, tone: 'idle', title: text('trouble.cancelled'), detail: said.detail || text('trouble.cancelled-about')};
    case 'paused':
      return {...said, tone: 'warn', title: text('trouble.paused'), detail: said.detail || text('trouble.paused-about')};
    case 'interrupted':
      return {...said, tone: 'warn', title: text('trouble.interrupted')};
    case 'failed':
      return {...said, tone: 'bad', title: text('trouble.failed')};
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
  return [{label: text('fact.pose'), text: !accepted || !solved ? text('fact.pose-kept', {reason: translated(reason)}) :
    text(confirms_told ? 'fact.pose-confirmed' : 'fact.pose-found', {distance: format.millimetres(solved.after_mm, 2)})}];
}

/** The parts left out of the model, if they have at least 0.1 cm³. @param {Model} model @returns {{label: string, text: string}[]} */
const droppedFacts = ({dropped_parts, dropped_volume_cm3}) => !dropped_parts || !(Number(dropped_volume_cm3) >= 0.1) ? [] :
  [{label: text('fact.left-out'), text: `${text('count.parts', {count: dropped_parts})}, ${format.number(Number(dropped_volume_cm3))} cm³`}];

/** What motor and platform did beside what they should. @param {Scan} scan @returns {{label: string, text: string, tone?: Tone}[]} */
const motorFacts = ({late_pulses, slips, seconds_settling}) => [
  ...(late_pulses > 0 ? [{label: text('fact.motor'), text: text('fact.late', {count: format.number(late_pulses)})}] : []),
  ...(slips > 0 ?
    [{label: text('fact.motor'), text: text('fact.slips', {count: slips}), tone: /** @type {const} */ ('warn')}] : []),
  ...(seconds_settling >= 0.1 ?
    [{label: text('fact.platform'), text: text('fact.swung', {time: `${format.number(seconds_settling)} s`})}] : []),
];

/**
 * The scans of the sides in the model in view, the first side first.
 * @param {State} state @param {Scan} scan @returns {Scan[]}
 */
function sidesOf(state, scan) {
  const merged = buildShown(state, scan)?.poses ?? [];
  const others = (scan.poses ?? []).filter(({pose}) => merged.includes(pose)).map((pose) => scanOf(state, pose.scan));
  return [scan, ...others.filter((side) => side !== null)];
}

const mostSizeError = 0.01;  // of the length: a board or a known length tells more

/** @param {import('./api/api.js').Model} model */
function sizeFacts({quality}) {
  if (!quality?.size_error) {
    return [];
  }
  const {mm, of_mm} = quality.size_error;
  const key = mm > mostSizeError * of_mm ? 'fact.size-error-large' : 'fact.size-error-of';
  const error = text(key, {error: format.millimetres(mm, 1), length: format.millimetres(of_mm, 0)});
  return [{label: text('fact.size-error'), text: error}];
}

/** @param {Scan} scan  as shown @param {Scan[]} sides @returns {{label: string, text: string, tone?: Tone}[]} */
function factsOf(scan, sides) {
  const {model, settings} = scan;
  const when = format.when(scan.created);
  const total = (/** @type {'snapshots_done' | 'snapshots_total' | 'seconds_elapsed'} */ key) =>
    sides.reduce((sum, side) => sum + side[key], 0);
  const all = {snapshots_done: total('snapshots_done'), snapshots_total: total('snapshots_total')};
  const duration = total('seconds_elapsed');
  const snapshots = text(`fact.${settings.filter}`, {taken: taken(all), frames: settings.frames});
  const lasted = duration > 0 ? text('fact.took', {when, duration: format.duration(duration)}) : when;
  const capture = [
    {label: text('fact.snapshots'), text: snapshots},
    {label: text('fact.taken'), text: lasted},
    ...poseFacts(scan),
    ...motorFacts(scan),
  ];
  if (!model) {
    return capture;
  }
  return [
    ...sizeFacts(model),
    {label: text('fact.triangles'), text: format.number(model.triangles)},
    model.watertight ? {label: text('fact.watertight'), text: text('yes')} : {label: text('fact.watertight'), text: text('fact.open'), tone: 'warn'},
    ...(model.filled_share === null ? [] :
      [{label: text('fact.seen'), text: text('fact.seen-share', {share: format.percent(1 - model.filled_share)})}]),
    {label: text('fact.volume'), text: `${format.number(model.volume_cm3)} cm³`},
    ...droppedFacts(model),
    {label: text('fact.detail'), text: text(`fact.${settings.method}`, {leaf: format.leaf(settings.leaf_size_mm)})},
    ...capture,
  ];
}

/** @param {Scan} scan */
const downloadOf = ({model}) => model && {url: model.url, about: format.bytes(model.bytes)};

/**
 * The offer to build a model for a scan that ended without one but has snapshots. A model that did not fit into memory is
 * offered with leaves of twice the side, which take an eighth of the memory.
 * @param {State} state @param {Scan} scan
 */
function unbuiltOf(state, {id, state: condition, model, error, settings, snapshots_done}) {
  const hasEnded = condition === 'cancelled' || condition === 'failed';
  if (model || !hasEnded || snapshots_done === 0 || error?.code === 'empty') {
    return null;
  }
  const leaf_size_mm = error?.code === 'memory-limit' ? 2 * settings.leaf_size_mm : settings.leaf_size_mm;
  const build = runOf(state, id);
  return {
    settings: {leaf_size_mm, choose: true},
    about: text('scan.build-first-about', {snapshots: text('count.snapshots', {count: snapshots_done}), leaf: format.leaf(leaf_size_mm)}),
    isBusy: isBuildBusy(state, id),
    isGoing: Boolean(build && isGoing(build)),
  };
}

/**
 * The verdict, and the reason whose places are shown.
 * @param {State} state @param {Scan} scan  as shown
 */
function verdictShown(state, {model, calibration}) {
  const verdict = model && verdictOf(model, calibration?.findings);
  return verdict && {...verdict, reasons: verdict.reasons.map((reason) => ({...reason, isShown: reason.key === state.shownReason}))};
}

/**
 * Further downloads: the shown model in other formats, and the raw scan.
 * @param {string[]} endings  of the formats
 * @param {Scan} scan  as shown
 */
function formatsOf(endings, {id, model, state, snapshots_done, has_colours}) {
  const others = model ? endings.filter((ending) => ending !== 'stl').map((ending) => ({format: ending.toUpperCase(), url: model.url.replace(/stl$/, ending)})) : [];
  const models = [
    ...others.map(({format: name, url}) => ({name, title: text('scan.format', {format: name}), url})),
    ...(has_colours ? others : []).map(({format: name, url}) =>
      ({name: text('scan.coloured', {format: name}), title: text('scan.format', {format: text('scan.coloured', {format: name})}), url: `${url}?colour=true`})),
  ];
  const raw = {name: text('scan.raw'), title: text('scan.raw-about'), url: `api/v1/scans/${id}/scan.zip`};
  return state !== 'running' && snapshots_done > 0 ? [...models, raw] : models;
}

/** @param {State} state @param {Scan} scan  as shown */
const detailsOf = (state, scan) => ({
  id: scan.id,
  name: nameOf(scan),
  trouble: troubleOf(scan),
  verdict: verdictShown(state, scan),
  size: scan.model ? format.size(scan.model.size_mm) : '',
  facts: factsOf(scan, sidesOf(state, scan)),
  canResume: scan.can_resume ?? (scan.state === 'paused' || scan.state === 'interrupted'),
  canEnd: scan.state === 'paused' || scan.state === 'interrupted',
  download: downloadOf(scan),
  formats: formatsOf(state.formats, scan),
  unbuilt: unbuiltOf(state, scan),
});

/** @param {State} state */
const rowOf = (state) => (/** @type {Scan} */ scan) => ({
  id: scan.id,
  name: nameOf(scan),
  badge: scan.model && badgeOf(scan.model) || {tone: tones[scan.state], text: text(`state.${scan.state}`)},
  when: scan.name ? format.when(scan.created) : '',  // otherwise the date is the name
  about: scan.model ? `${format.size(scan.model.size_mm, 0)} · ${format.bytes(scan.model.bytes)}` :
    text(scan.state === 'running' ? 'library.taken' : 'library.kept', {taken: taken(scan)}),
  download: scan.model?.url ?? null,
  isCurrent: scan.id === (state.selected ?? running(state)?.id),
  isRunning: scan.state === 'running',
  picture: pictureOf(scan),
  isChosen: state.library.chosen?.includes(scan.id) ?? false,
  tags: scan.tags,
});

/** The library: matching scans up to the limit. @param {State} state */
function libraryOf(state) {
  const scans = state.scans.filter((scan) => !isPartOfAnother(scan));
  const matches = found(scans, state.library, nameOf);
  const {limit, chosen, query} = state.library;
  return {
    rows: matches.slice(0, limit).map(rowOf(state)),
    isListed: state.listed !== null,
    count: scans.length,
    summary: query ? text('count.of', {done: matches.length, total: scans.length}) : scans.length > 0 ? format.number(scans.length) : '',
    more: Math.max(matches.length - limit, 0),
    isChoosing: chosen !== null,
    chosen: scans.filter(({id}) => chosen?.includes(id)).map(({id}) => id),
    found: matches.filter(({state: condition}) => condition !== 'running').map(({id}) => id),
    tags: knownTags(state.scans),
    formats: state.formats,
  };
}

/** @param {Device} device */
const isBroken = ({state}) => state === 'missing' || state === 'failed';

/** @param {'sensor' | 'turntable'} role @param {Device} device @param {boolean} isAway  whether the scanner does not answer, so that its last status may be outdated */
function deviceOf(role, device, isAway) {
  const isReady = device.state === 'ready';
  const name = text(`device.${role}`);
  const state = text(`device.${device.state}`);
  return {
    role,
    tone: isAway ? 'idle' : isReady ? 'good' : 'bad',
    name: translated(device.name) || name,
    text: isAway ? text('device.away') : state,
    message: isReady ? '' : format.sentence(device.message || text('device.trouble', {device: name, state})),
  };
}

/** What the form says of a scan that is not finished. @param {State} state */
function unfinishedOf(state) {
  const scan = unfinished(state);
  return scan && {id: scan.id, text: text('form.unfinished', {name: nameOf(scan), taken: taken(scan)})};
}

/** @param {State} state */
function titleOf(state) {
  const scan = running(state);
  if (isAway(state)) {
    return `${text('title.away')} · Octurn`;
  }
  if (scan) {
    return isBuilding(scan) ? `${text('title.building')} · Octurn` : `${scan.snapshots_done}/${scan.snapshots_total} · Octurn`;
  }
  const shown = scanOf(state, state.selected);
  return shown ? `${nameOf(shown)} · Octurn` : 'Octurn';
}

/**
 * The announcement for screen readers: one for each quarter of the turn, not for each stop.
 * @param {State} state
 */
function announcementOf(state) {
  const scan = running(state);
  if (scan) {
    const quarter = Math.floor(4 * scan.snapshots_done / Math.max(scan.snapshots_total, 1)) * 25;
    return isBuilding(scan) || scan.error ? `${phaseText(scan)}.` :
      quarter === 0 ? text('spoken.start', {count: scan.snapshots_total}) : text('spoken.quarter', {percent: quarter});
  }
  const shown = scanOf(state, state.selected);
  if (!shown?.model) {
    return shown ? `${troubleOf(shown)?.title ?? ''}.` : '';
  }
  const verdict = verdictOf(shown.model);
  return `${text('spoken.ready', {name: nameOf(shown)})}${verdict && verdict.tone !== 'good' ? ` ${verdict.title}.` : ''}`;
}

/** @param {State} state */
export function screenOf(state) {
  const scan = running(state);
  const chosen = scanOf(state, state.selected);
  const panel = !state.status ? 'waiting' : chosen ? 'details' : scan ? 'progress' : 'form';
  const shown = chosen && asShown(state, chosen);
  const details = shown && detailsOf(state, shown);
  const hasModel = panel === 'details' && Boolean(shown?.model);
  const growing = panel === 'progress' && scan ? scan.preview : null;
  const has3D = hasModel || growing !== null;
  const away = isAway(state);
  const devices = state.status ? [deviceOf('sensor', state.status.sensor, away), deviceOf('turntable', state.status.turntable, away)] : [];
  return {
    title: titleOf(state),
    announcement: announcementOf(state),
    isAway: away,
    isBusy: state.isPending,
    canStart: [state.status?.sensor, state.status?.turntable].every((device) => device && !isBroken(device)),
    isSimulated: Boolean(state.status?.sensor.simulated || state.status?.turntable.simulated),
    devices,
    panel,
    unfinished: unfinishedOf(state),
    progress: scan && {...progressOf(scan), ...(state.stopping === scan.id ? {text: text('phase.stopping')} : {}), isStopping: state.stopping === scan.id, ...(away ? {text: text('progress.away'), left: '', time: '', isStale: true} : {isStale: false})},
    details,
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
      paint: /** @type {const} */ (chosen?.has_colours ? 'colours' : chosen?.has_views ? 'views' : null),
      isSolid: shown?.settings.method === 'solid',
      object: chosen?.id ?? '',
      places: details?.verdict?.reasons.find(({isShown}) => isShown)?.places ?? [],
      growing,
      name: chosen ? nameOf(chosen) : growing ? text('stage.seen') : '',
      sensor: translated(state.status?.sensor.name ?? ''),
      isReachable: !away,
      isLive: state.status?.sensor.state === 'ready' && !away,
      isScanning: scan !== null,
      hasHints: scan === null && !(panel === 'details' && details?.canResume),  // on how the next scan may fail
    },
    ...libraryOf(state),
    footer: state.status ? {version: `Octurn ${state.status.version}`, disk: text('foot.free', {bytes: format.bytes(state.status.disk_free_bytes)})} : null,
  };
}
