// The page's state and its transitions. Pure: no network, clock or DOM. screen.js derives the view from it.

import {isGoing, markOfBuilds} from './scan/builds.js';
import {initial as library} from './library/library.js';

/** @typedef {import('./api/api.js').Status} Status */
/** @typedef {import('./api/api.js').Scan} Scan */
/** @typedef {import('./api/api.js').Settings} Settings */
/** @typedef {import('./api/api_builds.js').Build} Build */

/**
 * @typedef {Object} State
 * @property {number} failures  consecutive status requests without an answer
 * @property {Status | null} status  the last one, also while the scanner is away
 * @property {Scan[]} scans  newest first
 * @property {string | null} listed  mark of the status to which `scans` belongs
 * @property {Settings | null} defaults
 * @property {string[]} formats  of models, such as "stl"
 * @property {string | null} selected  the scan in view; null for the form or the running scan
 * @property {{scan: string, list: Build[], mark: string} | null} builds  of the scan in view
 * @property {number | null} shownBuild  the build in view; null for the scan's model
 * @property {string | null} shownReason  the verdict's reason whose places are shown
 * @property {import('./library/library.js').Library} library
 * @property {'camera' | 'model'} stage  content of the large picture if there is a choice
 * @property {string | null} stopping  the running scan that this page has asked to pause or to end
 * @property {boolean} isPending  whether a request is waiting for its response
 * @property {{title: string, detail: string, hint: string} | null} problem  why the last request failed
 */

/** @type {State} */
export const initial = {
  failures: 0,
  status: null,
  scans: [],
  listed: null,
  defaults: null,
  formats: [],
  selected: null,
  builds: null,
  shownBuild: null,
  shownReason: null,
  library,
  stage: 'camera',
  stopping: null,
  isPending: false,
  problem: null,
};

const failuresUntilAway = 2;

/** @param {State} state */
export const isAway = (state) => state.failures >= failuresUntilAway;

/** @param {State} state */
export const running = (state) => state.status?.scan ?? null;

/** @param {State} state @param {string | null} id */
export const scanOf = (state, id) => state.scans.find((scan) => scan.id === id) ?? null;

/** @param {Status} status */
const mark = (status) => `${status.scan?.id} ${status.scans_revision} ${markOfBuilds(status)}`;

/** Whether scans were added, ended or changed since the list was read, by this or another browser. @param {State} state */
export const isListStale = (state) => state.status !== null && state.listed !== mark(state.status);

/** Replaces a scan in a list, or adds it. @param {Scan[]} scans @param {Scan} scan */
const merged = (scans, scan) => scans.some(({id}) => id === scan.id) ?
    scans.map((other) => other.id === scan.id ? scan : other) : [scan, ...scans];

/**
 * A scan that ends while it is in view stays in view: its result replaces its progress. The result of a further pose is on the
 * first scan's page, as it may have changed that scan's models.
 * @param {State} state @param {Status} status @returns {State}
 */
export function withStatus(state, status) {
  const before = running(state);
  const ended = before !== null && before.id !== status.scan?.id;
  const stopping = state.stopping === status.scan?.id ? state.stopping : null;
  const news = {...state, status, stopping, failures: 0, scans: status.scan ? merged(state.scans, status.scan) : state.scans};
  const shown = before?.pose_of?.scan ?? before?.id ?? null;
  const renewed = ended && before.pose_of ? {...news, builds: null, shownBuild: null} : news;
  if (status.scan && state.selected === status.scan.id) {
    return {...renewed, selected: null};  // opened by its address, or resumed from another browser: show its progress
  }
  return ended && state.selected === null ? {...renewed, selected: shown, stage: 'model'} : renewed;
}

/** A scan that waits to be continued or ended. @param {State} state */
export const unfinished = (state) => state.scans.find(({state: condition, pose_of}) =>
  (condition === 'paused' || condition === 'interrupted') && !pose_of) ?? null;

/** @param {State} state @returns {State} */
export const withoutAnswer = (state) => ({...state, failures: state.failures + 1});

/** @param {State} state @param {Scan[]} scans @returns {State} */
export function withScans(state, scans) {
  const isGone = state.selected !== null && !scans.some(({id}) => id === state.selected);
  return {...state, scans, listed: state.status && mark(state.status), selected: isGone ? null : state.selected};
}

/** @param {State} state @param {Scan} scan @returns {State} */
export const withScan = (state, scan) => ({...state, scans: merged(state.scans, scan)});

/** @param {State} state @param {Scan} scan  just started or resumed by this page @returns {State} */
export const withStarted = (state, scan) => withSelected(
    state.status ? withStatus(state, {...state.status, scan}) : withScan(state, scan), null);

/** @param {State} state @param {string} id @returns {State} */
export const withoutScan = (state, id) => ({
  ...state,
  scans: state.scans.filter((scan) => scan.id !== id),
  selected: state.selected === id ? null : state.selected,
});

/** @param {State} state @param {Settings} defaults @param {string[]} formats  of models @returns {State} */
export const withDefaults = (state, defaults, formats) => ({...state, defaults, formats});

/** Selects a scan; none if the list does not have it. @param {State} state @param {string | null} selected @returns {State} */
export const withSelected = (state, selected) => ({
  ...state,
  selected: selected === running(state)?.id || (state.listed !== null && !scanOf(state, selected)) ? null : selected,
  shownBuild: selected === state.selected ? state.shownBuild : null,
  shownReason: null,
  stage: 'model',
  problem: null,
});

/** @param {State} state @param {Build} build  just begun by this page @returns {State} */
export const withBuild = (state, build) => ({
  ...state,
  status: state.status && {...state.status, ...(build.cluster_job ?
    {cluster_builds: [...state.status.cluster_builds ?? [], build]} : {build})},
  builds: state.builds?.scan === build.scan ? {...state.builds, list: [...state.builds.list.filter(({model}) => model), build]} : state.builds,
});

/** Whether builds of the scan in view were added or ended since they were read. @param {State} state */
export const areBuildsStale = ({selected, builds, status, scans, listed}) =>
  selected !== null && (listed === null || scans.some(({id}) => id === selected)) && (builds?.scan !== selected || builds.mark !== markOfBuilds(status));

/**
 * A build that ends while its scan is in view is shown.
 * @param {State} state @param {string} scan @param {Build[]} list @returns {State}
 */
export function withBuilds(state, scan, list) {
  const before = state.builds?.scan === scan ? state.builds.list : [];
  const ended = list.find(({build, model}) => model && before.some((other) => other.build === build && !other.model));
  const news = {...state, builds: {scan, list, mark: markOfBuilds(state.status)}};
  return ended ? withShownBuild(news, ended.build) : news;
}

/** @param {State} state @param {number | null} shownBuild @returns {State} */
export const withShownBuild = (state, shownBuild) => ({...state, shownBuild, shownReason: null, stage: 'model'});

/** Shows the places of a reason, or hides them. @param {State} state @param {string} reason @returns {State} */
export const withReason = (state, reason) => ({...state, shownReason: state.shownReason === reason ? null : reason, stage: 'model'});

/** @param {State} state @param {Partial<State['library']>} changes @returns {State} */
export const withLibrary = (state, changes) => ({...state, library: {...state.library, ...changes}});

/** @param {State} state @param {string | null} stopping @returns {State} */
export const withStopping = (state, stopping) => ({...state, stopping});

/** @param {State} state @param {State['stage']} stage @returns {State} */
export const withStage = (state, stage) => ({...state, stage});

/** @param {State} state @returns {State} */
export const withPending = (state) => ({...state, isPending: true, problem: null});

/** @param {State} state @returns {State} */
export const withAnswer = (state) => ({...state, isPending: false});

/** @param {State} state @param {State['problem']} problem @returns {State} */
export const withProblem = (state, problem) => ({...state, problem});

/** Marks the list as stale after a refusal, which an outdated list may have caused. @param {State} state @returns {State} */
export const withStaleList = (state) => ({...state, listed: null});

/**
 * The pause before the next status request, milliseconds: short while a scan runs, with exponential backoff while there is no
 * answer.
 * @param {State} state
 */
export function pause(state) {
  if (state.failures > 0) {
    return Math.min(500 * 2 ** (state.failures - 1), 8000);
  }
  const {build} = state.status ?? {};
  return running(state) || (build && isGoing(build)) ? 400 : 1000;
}

/**
 * Whether a model is loaded automatically; a model that could fill a phone's memory is not.
 * @param {number} bytes  of the file
 * @param {boolean} isHandheld
 */
export const loadsUnasked = (bytes, isHandheld) => bytes <= (isHandheld ? 20e6 : 160e6);

/** Whether a model is so large that its coarse mesh loads much sooner. @param {number} bytes  of the file */
export const hasCoarse = (bytes) => bytes > 250e3;

/** The URL of a model's coarse mesh. @param {import('./api/api.js').Model} model */
export const coarseUrl = ({url}) => url.replace(/Scan\.stl$/, 'coarse.stl');
