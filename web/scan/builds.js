// The view of the models built from a scan. Pure: state in, texts and choices out.

import * as format from '../base/format.js';
import {badgeOf} from './quality.js';
import {text, translated} from '../base/texts.js';
import {refusalText} from '../base/wording.js';

/** @typedef {import('../api/api_builds.js').Build} Build */
/** @typedef {import('../api/api.js').Scan} Scan */
/** @typedef {import('../state.js').State} State */

/** Faults of a model that a solved pose may cure. */
const faultsOfPose = new Set(['stops-disagree', 'floats', 'sunk']);

/** Whether a model was cut, erased, laid or scaled. @param {import('./edits.js').Edits} edits */
export const isEdited = ({cut_mm, erase_mm, lay_mm, scale}) =>
  Boolean(cut_mm?.length || erase_mm?.length || lay_mm) || (scale ?? 1) !== 1;

/** @param {Build} build */
export const isGoing = ({state}) => state === 'waiting' || state === 'running';

/** A key that changes with a build's state. @param {Build | null | undefined} build */
export const markOf = (build) => build ? `${build.scan} ${build.build} ${build.state}` : '';

/** A key that changes with the state of any running build. @param {import('../api/api.js').Status | null | undefined} status */
export const markOfBuilds = (status) => [status?.build, ...status?.cluster_builds ?? []].map(markOf).join(' ');

/**
 * The running build of a scan, here or on a cluster, or the last one that left no model.
 * @param {State} state @param {string} scan @returns {Build | null}
 */
export function runOf({status}, scan) {
  const runs = [status?.build, ...status?.cluster_builds ?? []].filter((run) => run?.scan === scan);
  return runs.find((run) => run && isGoing(run)) ?? runs.at(-1) ?? null;
}

/** Whether no further build can begin now; a cluster takes any number. @param {State} state @param {string} scan */
export function isBuildBusy(state, scan) {
  const run = state.status?.cluster_builds ? runOf(state, scan) : state.status?.build;
  return Boolean(run && isGoing(run)) || Boolean(state.status?.scan && !state.status.cluster_builds);
}

/** The known builds of a scan that have a model. @param {State} state @param {string} id */
const modelsOf = ({builds}, id) => builds?.scan === id ? builds.list.filter(({model}) => model !== null) : [];

/** The build in view. @param {State} state @param {Scan} scan @returns {Build | null} */
export function buildShown(state, scan) {
  const models = modelsOf(state, scan.id);
  return models.find(({build}) => build === state.shownBuild) ?? models.find(({chosen}) => chosen) ?? null;
}

/**
 * A scan with the model in view and the settings of that model.
 * @param {State} state @param {Scan} scan @returns {Scan}
 */
export function asShown(state, scan) {
  const build = buildShown(state, scan);
  if (!build?.model) {
    return scan;
  }
  const settings = /** @type {import('../api/api.js').Settings} */ ({...scan.settings, ...build.settings});
  const isSolvedAlready = settings.calibrate === 'auto' && !build.calibration;
  const url = build.chosen ? /** @type {import('../api/api.js').Model} */ (scan.model ?? build.model).url : build.model.url;
  return {...scan, settings, model: {...build.model, url}, calibration: isSolvedAlready ? scan.calibration : build.calibration};
}

/** The URL of the model in the picture, different for each build. @param {Scan} scan @param {Build | null} build */
export const pictureUrl = (scan, build) => `api/v1/scans/${scan.id}/builds/${build?.build ?? scan.build ?? 0}/Scan.stl`;

/** Whether a model was made without a solved pose and has faults that one may cure. @param {Scan} scan  as shown */
export const isCrooked = ({model, settings, calibration}) => (settings.calibrate === 'told' || !calibration) &&
    Boolean(model?.quality?.reasons.some(({code}) => faultsOfPose.has(code)));

/** @param {Build} build */
const nameOf = ({build, poses}) => build === 0 ? text('build.first') :
    poses && poses.length > 0 ? text('build.name-sides', {number: build, sides: poses.length + 1}) : text('build.name', {number: build});

/** @param {Build} build */
function phaseText({state, phase, snapshots_done, snapshots_total, cluster_job}) {
  const detail = translated(cluster_job?.detail ?? '');
  if (state === 'waiting') {
    return detail ? text('build.queued', {detail}) : text('build.waiting');
  }
  if (detail) {
    return detail;
  }
  switch (phase) {
    case 'calibrating': return text('build.calibrating');
    case 'registering': return text('build.registering');
    case 'rebuilding': return text('build.rebuilding', {done: Math.max(snapshots_done, 1), total: snapshots_total});
    case 'building': return text('phase.building');
    default: return text('phase.starting');
  }
}

/** The progress of reading snapshots, which takes most of the time. @param {Build} build @returns {number | null} 0 to 1; null: unknown */
const shareOf = ({phase, snapshots_done, snapshots_total}) => phase === 'rebuilding' && snapshots_total > 0 ?
    snapshots_done / snapshots_total : null;

/** @param {Build} build */
function troubleOf({state, error}) {
  const title = text(state === 'failed' ? 'build.failed' : 'build.cancelled');
  return error && (state === 'failed' || state === 'cancelled') ?
    {title, text: [refusalText(error), error.hint].map(format.sentence).join(' ')} : null;
}

/** @param {Build} build @param {number | undefined} shown */
const rowOf = ({build, model, settings, calibration, created, chosen, poses}, shown) => ({
  number: build,
  name: nameOf(/** @type {Build} */ ({build, poses})),
  badge: model && badgeOf(model),
  when: format.when(created),
  about: [
    text(`fact.${settings.method}`, {leaf: format.leaf(settings.leaf_size_mm)}),
    text(settings.calibrate === 'told' ? 'build.pose-stored' : calibration && !calibration.accepted ? 'build.pose-missing' : 'build.pose-checked'),
    isEdited(settings) ? text('build.edited') : '',
    model ? format.bytes(model.bytes) : '',
  ].filter(Boolean).join(' · '),
  isShown: build === shown,
  isChosen: chosen,
  canRemove: !chosen && build !== 0 && !poses?.length,  // builds with further poses are deleted with the poses
  download: model?.url ?? '',
  place: JSON.stringify([settings.lay_mm ?? null, settings.scale ?? 1]),
});

/**
 * @param {State} state @param {Scan} scan  in view
 */
export function buildsOf(state, scan) {
  const mine = runOf(state, scan.id);
  const shown = buildShown(state, scan)?.build;
  const models = modelsOf(state, scan.id);
  const hasEnded = scan.state === 'finished' || scan.state === 'cancelled' || scan.state === 'failed';
  return {
    scan: scan.id,
    canBuild: (hasEnded || Boolean(mine)) && scan.snapshots_done > 0,
    isBusy: isBuildBusy(state, scan.id),
    canStraighten: isCrooked(asShown(state, scan)),
    rows: models.length > 1 || (models.length === 1 && !scan.model) ? models.map((build) => rowOf(build, shown)) : [],
    going: mine && isGoing(mine) ? {number: mine.build, text: phaseText(mine), share: shareOf(mine)} : null,
    trouble: mine && troubleOf(mine),
    settings: asShown(state, scan).settings,
  };
}
