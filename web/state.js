// What the page knows, and how news change it. Pure: nothing here touches the network, the clock or the DOM.
// screen.js tells what is shown of it.

import {isGoing, markOfBuilds} from './builds.js';
import {initial as library} from './library.js';

/** @typedef {import('./api.js').Status} Status */
/** @typedef {import('./api.js').Scan} Scan */
/** @typedef {import('./api.js').Settings} Settings */
/** @typedef {import('./api_builds.js').Build} Build */

/**
 * @typedef {Object} State
 * @property {number} failures  status requests in a row that were not answered
 * @property {Status | null} status  the last one, also while the scanner is away
 * @property {Scan[]} scans  newest first
 * @property {string | null} listed  mark of the status that `scans` belongs to
 * @property {Settings | null} defaults
 * @property {string | null} selected  the scan that is looked at; null for the form or the running scan
 * @property {{scan: string, list: Build[], mark: string} | null} builds  of the scan that is looked at
 * @property {number | null} shownBuild  the one that is looked at; null for the scan's model
 * @property {string | null} shownReason  of the verdict, whose places are shown
 * @property {import('./library.js').Library} library
 * @property {'camera' | 'model'} stage  what the large picture shows when there is a choice
 * @property {boolean} isPending  something was asked of the scanner and is not yet answered
 * @property {{title: string, detail: string, hint: string} | null} problem  why the last thing asked for was not done
 */

/** @type {State} */
export const initial = {
  failures: 0,
  status: null,
  scans: [],
  listed: null,
  defaults: null,
  selected: null,
  builds: null,
  shownBuild: null,
  shownReason: null,
  library,
  stage: 'camera',
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

/** Whether scans came, ended or changed since the list was read, from here or from another browser. @param {State} state */
export const isListStale = (state) => state.status !== null && state.listed !== mark(state.status);

/** @param {Scan[]} scans @param {Scan} scan  it replaces the one it is, or is new */
const merged = (scans, scan) => scans.some(({id}) => id === scan.id) ?
    scans.map((other) => other.id === scan.id ? scan : other) : [scan, ...scans];

/**
 * A scan that ends while it is looked at stays in view: its result appears where its progress was. That of another
 * pose has it on the page of the first scan, whose models it may have changed.
 * @param {State} state @param {Status} status @returns {State}
 */
export function withStatus(state, status) {
  const before = running(state);
  const ended = before !== null && before.id !== status.scan?.id;
  const news = {...state, status, failures: 0, scans: status.scan ? merged(state.scans, status.scan) : state.scans};
  const shown = before?.pose_of?.scan ?? before?.id ?? null;
  const renewed = ended && before.pose_of ? {...news, builds: null, shownBuild: null} : news;
  if (status.scan && state.selected === status.scan.id) {
    return {...renewed, selected: null};  // by its address, or resumed from another browser: its progress is shown
  }
  return ended && state.selected === null ? {...renewed, selected: shown, stage: 'model'} : renewed;
}

/** @param {State} state @returns {State} */
export const withoutAnswer = (state) => ({...state, failures: state.failures + 1});

/** @param {State} state @param {Scan[]} scans @returns {State} */
export function withScans(state, scans) {
  const isGone = state.selected !== null && !scans.some(({id}) => id === state.selected);
  return {...state, scans, listed: state.status && mark(state.status), selected: isGone ? null : state.selected};
}

/** @param {State} state @param {Scan} scan @returns {State} */
export const withScan = (state, scan) => ({...state, scans: merged(state.scans, scan)});

/** @param {State} state @param {Scan} scan  just started or resumed from here @returns {State} */
export const withStarted = (state, scan) => withSelected(
    state.status ? withStatus(state, {...state.status, scan}) : withScan(state, scan), null);

/** @param {State} state @param {string} id @returns {State} */
export const withoutScan = (state, id) => ({
  ...state,
  scans: state.scans.filter((scan) => scan.id !== id),
  selected: state.selected === id ? null : state.selected,
});

/** @param {State} state @param {Settings} defaults @returns {State} */
export const withDefaults = (state, defaults) => ({...state, defaults});

/** @param {State} state @param {string | null} selected @returns {State} */
export const withSelected = (state, selected) => ({
  ...state,
  selected: selected === running(state)?.id ? null : selected,
  shownBuild: selected === state.selected ? state.shownBuild : null,
  shownReason: null,
  stage: 'model',
  problem: null,
});

/** @param {State} state @param {Build} build  just begun from here @returns {State} */
export const withBuild = (state, build) => ({
  ...state,
  status: state.status && {...state.status, ...(build.cluster_job ?
    {cluster_builds: [...state.status.cluster_builds ?? [], build]} : {build})},
  builds: state.builds?.scan === build.scan ? {...state.builds, list: [...state.builds.list.filter(({model}) => model), build]} : state.builds,
});

/** Whether builds of the scan that is looked at came or ended since they were read. @param {State} state */
export const areBuildsStale = ({selected, builds, status}) =>
  selected !== null && (builds?.scan !== selected || builds.mark !== markOfBuilds(status));

/**
 * A build that ends while its scan is looked at comes into view.
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

/** @param {State} state @param {State['stage']} stage @returns {State} */
export const withStage = (state, stage) => ({...state, stage});

/** @param {State} state @returns {State} */
export const withPending = (state) => ({...state, isPending: true, problem: null});

/** @param {State} state @returns {State} */
export const withAnswer = (state) => ({...state, isPending: false});

/** @param {State} state @param {State['problem']} problem @returns {State} */
export const withProblem = (state, problem) => ({...state, problem});

/** Something was refused: perhaps the list that it was asked from is not what there is. @param {State} state @returns {State} */
export const withStaleList = (state) => ({...state, listed: null});

/**
 * How long to wait before asking for the status again, milliseconds: briskly while a scan runs, ever more
 * slowly while nobody answers.
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
 * Whether a model is shown without being asked for: not one that would fill the memory of a phone.
 * @param {number} bytes  of the file
 * @param {boolean} isHandheld
 */
export const loadsUnasked = (bytes, isHandheld) => bytes <= (isHandheld ? 20e6 : 160e6);

/** Whether a coarse mesh of a model is there much sooner than the model. @param {number} bytes  of the file */
export const hasCoarse = (bytes) => bytes > 250e3;

/** Where that mesh is. @param {import('./api.js').Model} model */
export const coarseUrl = ({url}) => url.replace(/Scan\.stl$/, 'coarse.stl');
