// Asks the scanner, keeps the state, and has it shown.

import * as api from './api.js';
import * as requests from './api_builds.js';
import * as poseRequests from './api_poses.js';
import {seeStatus, watchAppliance} from './appliance.js';
import {prepareBuilds} from './builds_view.js';
import {watchCamera} from './camera.js';
import {seeNewest, seeReport, watchSteps} from './checklist.js';
import {prepareDoctor} from './doctor.js';
import {element} from './dom.js';
import {chosenSettings, prepareForm} from './form.js';
import {here, preparePlaces, showPlace, titleAt} from './places.js';
import {preparePoses} from './poses_view.js';
import {nameOf, screenOf} from './screen.js';
import {prepareStage, renderStage} from './stage.js';
import * as states from './state.js';
import {askDelete, askDeleteBuild, askName, render} from './view.js';

let state = states.initial;
let actions = 0;  // asked of the scanner so far: a status from before one is old news after it

/** @param {states.State} next */
function change(next) {
  const wasSelected = state.selected;
  state = next;
  if (here() === 'scan' && wasSelected !== state.selected && location.hash.slice(1) !== (state.selected ?? '')) {
    location.hash = state.selected ?? '';
  }
  const screen = screenOf(state);
  render({...screen, title: titleAt(here(), screen.title)});
  renderStage(screen.stage);
}

/**
 * Does what the user asked for, one thing at a time, and shows why if it fails.
 * @param {string} failure  what did not happen then
 * @param {() => Promise<(state: states.State) => states.State>} action  tells how its answer changes the state
 */
async function act(failure, action) {
  if (state.isPending) {
    return;
  }
  change(states.withPending(state));
  try {
    const apply = await action();
    change(apply(states.withAnswer(state)));
  } catch (error) {
    const {title, detail, hint} = error instanceof api.Problem ? error : new api.Problem('page', String(error));
    change(states.withProblem(states.withAnswer(state), {title: failure, detail: detail || title, hint}));
  }
  ++actions;
}

const start = () => act('The scan did not start', async () => {
  const scan = await api.start(chosenSettings());
  return (now) => states.withStarted(now, scan);
});

const cancel = () => act('The scan was not cancelled', async () => {
  const id = states.running(state)?.id;
  if (id) {
    await api.cancel(id);
  }
  return (now) => now;
});

const resume = () => act('The scan was not resumed', async () => {
  const scan = await api.resume(/** @type {string} */ (state.selected));
  return (now) => states.withStarted(now, scan);
});

const end = () => act('The scan was not ended', async () => {
  const scan = await api.cancel(/** @type {string} */ (state.selected));
  return (now) => states.withScan(now, scan);
});

/** @param {string | null} id */
async function rename(id) {
  const scan = states.scanOf(state, id);
  const name = scan && await askName(nameOf(scan));
  if (scan && name !== null) {
    await act('The scan was not renamed', async () => {
      const renamed = await api.rename(scan.id, name);
      return (now) => states.withScan(now, renamed);
    });
  }
}

/** @param {string | null} id */
async function remove(id) {
  const scan = states.scanOf(state, id);
  if (scan && await askDelete(nameOf(scan))) {
    await act('The scan was not deleted', async () => {
      await api.remove(scan.id);
      return (now) => states.withoutScan(now, scan.id);
    });
  }
}

/** @param {Object} settings  of the scan that is looked at, those that are to differ */
const build = (settings) => act('The model is not being built', async () => {
  const begun = await requests.build(/** @type {string} */ (state.selected), settings);
  return (now) => states.withBuild(now, begun);
});

/** @param {number} number */
const cancelBuild = (number) => act('The build was not cancelled', async () => {
  await requests.cancelBuild(/** @type {string} */ (state.selected), number);
  return (now) => now;
});

/** @param {number} number */
const chooseBuild = (number) => act('The model was not changed', async () => {
  const scan = await requests.chooseBuild(/** @type {string} */ (state.selected), number);
  const builds = await requests.builds(scan.id);
  return (now) => states.withShownBuild(states.withBuilds(states.withScan(now, scan), scan.id, builds), null);
});

/** @param {number} number */
async function removeBuild(number) {
  const id = /** @type {string} */ (state.selected);
  if (await askDeleteBuild()) {
    await act('The model was not deleted', async () => {
      await requests.removeBuild(id, number);
      const builds = await requests.builds(id);
      return (now) => states.withBuilds(now.shownBuild === number ? states.withShownBuild(now, null) : now, id, builds);
    });
  }
}

const buildActions = {
  build,
  cancel: cancelBuild,
  show: (/** @type {number} */ number) => change(states.withShownBuild(state, number)),
  choose: chooseBuild,
  remove: removeBuild,
};

const poseActions = {
  add: () => act('The scan did not start', async () => {
    const scan = await poseRequests.startPose(/** @type {string} */ (state.selected));
    return (now) => states.withStarted(now, scan);
  }),
  remove: (/** @type {number} */ number) => act('The side was not taken back', async () => {
    const scan = await poseRequests.removePose(/** @type {string} */ (state.selected), number);
    const builds = await requests.builds(scan.id);
    return (now) => states.withShownBuild(states.withBuilds(states.withScan(now, scan), scan.id, builds), null);
  }),
};

/** The builds of the scan that is looked at, if they are not known yet. @param {states.State} now */
async function missingBuilds(now) {
  if (!states.areBuildsStale(now)) {
    return null;
  }
  prepareBuilds(buildActions);
  preparePoses(poseActions);
  const scan = /** @type {string} */ (now.selected);
  return {scan, list: await requests.builds(scan)};
}

/** One look at the scanner; what changed is shown at once, the list of scans with it. */
async function look() {
  const before = actions;
  try {
    const status = await api.status();
    seeStatus(status);
    seeNewest(status);
    const scans = states.isListStale(states.withStatus(state, status)) ? await api.scans() : null;
    const defaults = state.defaults ?? await api.defaults();
    const builds = await missingBuilds(states.withStatus(state, status)).catch(() => null);  // of a scan that is gone
    if (before !== actions || state.isPending) {
      return;
    }
    if (!state.defaults) {
      prepareForm(defaults);
    }
    const news = states.withDefaults(states.withStatus(state, status), defaults);
    const listed = scans ? states.withScans(news, scans) : news;
    change(builds && builds.scan === listed.selected ? states.withBuilds(listed, builds.scan, builds.list) : listed);
  } catch {
    change(states.withoutAnswer(state));
  }
}

let wake = () => {};

/** Looks again and again, for as long as the page is open. */
async function watch() {
  for (;;) {
    await look();
    await new Promise((/** @type {(value?: undefined) => void} */ done) => {
      const timer = setTimeout(done, states.pause(state));
      wake = () => {
        clearTimeout(timer);
        done();
      };
    });
  }
}

/** Shows what the address names: a part of the page, or a scan. */
function follow() {
  const isScan = here() === 'scan';
  change(isScan ? states.withSelected(state, location.hash.slice(1) || null) : state);
  showPlace();
}

function listen() {
  const click = (/** @type {string} */ id, /** @type {() => void} */ action) => element(id).addEventListener('click', action);
  element('form').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    start();
  });
  click('cancel', cancel);
  click('resume', resume);
  click('end', end);
  click('retry', () => wake());
  click('dismiss', () => change(states.withProblem(state, null)));
  click('show-model', () => change(states.withStage(state, 'model')));
  click('show-camera', () => change(states.withStage(state, 'camera')));
  click('details-rename', () => rename(state.selected));
  click('straighten', () => element('straighten').getAttribute('aria-disabled') !== 'true' && build({calibrate: 'auto', choose: true}));
  element('reasons').addEventListener('click', (/** @type {any} */ event) => {
    const reason = event.target.closest('.reason-places')?.closest('li').dataset.key;
    if (reason) {
      change(states.withReason(state, reason));
    }
  });
  element('rows').addEventListener('click', (/** @type {any} */ event) => {
    const id = event.target.closest('.scan').dataset.key;
    const what = event.target.closest('[data-do]')?.dataset.do;
    if (what === 'rename') {
      rename(id);
    } else if (what === 'delete') {
      remove(id);
    }
  });
  addEventListener('hashchange', follow);
  document.addEventListener('visibilitychange', () => document.hidden || wake());
}

follow();
listen();
preparePlaces();
prepareStage();
watch();
watchCamera();
watchAppliance();
prepareDoctor(seeReport).then(watchSteps);  // the first step is a check
