// The parts of a scan's page besides its figures: notes, models, further poses, and printers.

import {prepareBuilds, renderBuilds} from './builds_view.js';
import {element} from '../base/dom.js';
import {build, buildActions, poseActions} from './model_actions.js';
import {prepareNotes, showNotes} from './notes.js';
import {state} from '../page.js';
import {preparePoses, renderPoses} from './poses_view.js';
import {screenOf} from '../screen.js';
import {prepareSend} from './send.js';
import {showScanPage} from '../view.js';

/** @typedef {ReturnType<typeof screenOf>} Screen */

/** @param {Screen} screen */
function render({panel, poses, builds}) {
  if (panel === 'details') {
    showNotes();
  }
  renderPoses(panel === 'details' ? poses : null);
  renderBuilds(panel === 'details' ? builds : null);
}

const isUsable = (/** @type {string} */ id) => element(id).getAttribute('aria-disabled') !== 'true';

function listen() {
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
    showScanPage(render);
  }
  prepareBuilds(buildActions);
  preparePoses(poseActions);
}
