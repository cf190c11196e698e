// The parts of a scan's page besides its figures: notes, models, further poses, and printers.

import {prepareBuilds, renderBuilds} from './builds_view.js';
import {start} from '../api/api.js';
import {element, setVerbatim, show} from '../base/dom.js';
import {prepareCompare, showCompare} from './compare.js';
import {makeModel} from './make_model.js';
import {build, buildActions, poseActions} from './model_actions.js';
import {nextScan} from './next.js';
import {prepareNotes, showNotes} from './notes.js';
import {act, state} from '../page.js';
import {preparePoses, renderPoses} from './poses_view.js';
import {screenOf} from '../screen.js';
import {prepareSend} from './send.js';
import {prepareShare} from './share.js';
import {scanOf, withStarted} from '../state.js';
import {showScanPage} from '../view.js';
import {offerMaker} from './view_tools.js';

/** @typedef {ReturnType<typeof screenOf>} Screen */

/** @param {Screen} screen */
function render({panel, poses, builds, isAway, canStart}) {
  const scan = scanOf(state, state.selected);
  if (panel === 'details' && scan) {
    showNotes();
    showCompare();
    show(element('next'), scan.state === 'finished' && !scan.pose_of);
    setVerbatim(element('next-name'), nextScan(scan, state.scans).name);
    element('next').setAttribute('aria-disabled', String(isAway || !canStart));
  }
  renderPoses(panel === 'details' ? poses : null);
  renderBuilds(panel === 'details' ? builds : null);
}

const isUsable = (/** @type {string} */ id) => element(id).getAttribute('aria-disabled') !== 'true';

/** Scans the next object as this one. */
const startNext = () => act('failure.start', async () => {
  const scan = scanOf(state, state.selected);
  const started = scan && await start(nextScan(scan, state.scans));
  return (now) => started ? withStarted(now, started) : now;
});

function listen() {
  element('next').addEventListener('click', () => isUsable('next') && startNext());
  element('straighten').addEventListener('click', () => isUsable('straighten') && build({calibrate: 'auto', choose: true}));
  element('build-first').addEventListener('click', () => {
    const unbuilt = isUsable('build-first') && screenOf(state).details?.unbuilt;
    unbuilt && build(unbuilt.settings);
  });
}

let isPrepared = false;

/** Attaches the handlers. Further calls fetch fragments that are still missing. */
export function prepare() {
  if (!isPrepared) {
    isPrepared = true;
    listen();
    prepareNotes();
    prepareSend();
    prepareShare();
    prepareCompare();
    offerMaker(makeModel);
    showScanPage(render);
  }
  prepareBuilds(buildActions);
  preparePoses(poseActions);
}
