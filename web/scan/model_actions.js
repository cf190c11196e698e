// Actions on the models of the scan in view: build again, choose one, join another side.

import * as api from '../api/api.js';
import * as binRequests from '../api/api_bin.js';
import * as requests from '../api/api_builds.js';
import * as poseRequests from '../api/api_poses.js';
import {offerUndo} from './bin.js';
import {openFit} from './fit_view.js';
import {act, change, state} from '../page.js';
import * as states from '../state.js';
import {text} from '../base/texts.js';
import {askDeleteBuild} from '../view.js';

/** @param {Object} settings  that differ from those of the scan in view */
export const build = (settings) => act('failure.build', async () => {
  const begun = await requests.build(/** @type {string} */ (state.selected), settings);
  return (now) => states.withBuild(now, begun);
});

/** @param {number} number */
const cancelBuild = (number) => act('failure.cancel-build', async () => {
  await requests.cancelBuild(/** @type {string} */ (state.selected), number);
  return (now) => now;
});

/** @param {number} number */
const chooseBuild = (number) => act('failure.choose-build', async () => {
  const scan = await requests.chooseBuild(/** @type {string} */ (state.selected), number);
  const builds = await requests.builds(scan.id);
  return (now) => states.withShownBuild(states.withBuilds(states.withScan(now, scan), scan.id, builds), null);
});

/** @param {number} number */
async function removeBuild(number) {
  const id = /** @type {string} */ (state.selected);
  if (await askDeleteBuild()) {
    await act('failure.delete-build', async () => {
      await requests.removeBuild(id, number);
      const builds = await requests.builds(id);
      return (now) => states.withBuilds(now.shownBuild === number ? states.withShownBuild(now, null) : now, id, builds);
    });
  }
}

export const buildActions = {
  build,
  cancel: cancelBuild,
  show: (/** @type {number} */ number) => change(states.withShownBuild(state, number)),
  choose: chooseBuild,
  remove: removeBuild,
};

/** Returns a removed pose from the bin. @param {string} first  the scan that it joins again @param {string} pose */
const restorePose = (first, pose) => act('failure.restore', async () => {
  await binRequests.restore(pose);
  const scans = await api.scans();
  const builds = await requests.builds(first);
  return (now) => states.withShownBuild(states.withBuilds(states.withScans(now, scans), first, builds), null);
});

let lookedAt = 0;  // pose whose fit is in view

export const poseActions = {
  add: () => act('failure.start', async () => {
    const scan = await poseRequests.startPose(/** @type {string} */ (state.selected));
    return (now) => states.withStarted(now, scan);
  }),
  look: (/** @type {number} */ number) => {
    const pose = states.scanOf(state, state.selected)?.poses?.find((other) => other.pose === number);
    if (pose && state.selected) {
      lookedAt = number;
      openFit(state.selected, pose);
    }
  },
  choose: (/** @type {Object} */ choice) => act('failure.fit', async () => {
    const begun = await poseRequests.choosePose(/** @type {string} */ (state.selected), lookedAt, choice);
    return (now) => states.withBuild(now, begun);
  }),
  remove: (/** @type {number} */ number) => act('failure.remove-side', async () => {
    const first = /** @type {string} */ (state.selected);
    const pose = states.scanOf(state, first)?.poses?.find((other) => other.pose === number);
    const scan = await poseRequests.removePose(first, number);
    const builds = await requests.builds(first);
    if (pose) {
      offerUndo(text('side.name', {side: number + 1}), () => restorePose(first, pose.scan));
    }
    return (now) => states.withShownBuild(states.withBuilds(states.withScan(now, scan), first, builds), null);
  }),
};
