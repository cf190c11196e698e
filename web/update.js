// "Update": sends a file to the scanner, and tells what becomes of it, across the restart that it takes.

import * as api from './api.js';
import {element, part, setText, show} from './dom.js';
import {bytes, sentence} from './format.js';

/** @typedef {import('./api.js').Update} Update */

/**
 * @typedef {Object} State
 * @property {Update} update  as the scanner told it last
 * @property {{sent: number, total: number} | null} sending  bytes of a file that goes there from here
 * @property {boolean} isScanning
 * @property {boolean} isAway  the scanner does not answer
 * @property {boolean} isFollowed  this page has seen the update coming
 * @property {string} failure  why the last file was not taken, or empty
 */

const mostBytes = 160 * 2 ** 20;
const mark = 'octurn-update';  // in the session's storage: an update was seen coming, before the page was loaded again

const phases = /** @type {const} */ (['sending', 'installing', 'restarting', 'trial']);

/** What is going on. Pure. @param {State} state @returns {typeof phases[number] | null} */
export function phaseOf({update, sending, isAway, isFollowed}) {
  const phase = phases.find((name) => name === update.state) ?? null;
  if (sending || update.state === 'receiving') {
    return 'sending';
  }
  return isFollowed && isAway && phase === 'installing' ? 'restarting' : phase;
}

const words = {
  sending: 'Sending the file',
  installing: 'Checking and writing',
  restarting: 'Starting again',
  trial: 'Trying the new version',
};

/** @param {ReturnType<typeof phaseOf>} phase @param {State} state */
function textOf(phase, {sending}) {
  switch (phase) {
    case 'sending': return sending ? `${bytes(sending.sent)} of ${bytes(sending.total)}` : 'Another page sends a file.';
    case 'installing': return 'The file is checked and written beside the version that runs. This takes a few minutes.';
    case 'restarting': return 'This page goes on by itself when the scanner is back, in about a minute.';
    case 'trial': return 'The new version runs. It is kept if it goes on running; else the earlier one comes back.';
    default: return '';
  }
}

/** @param {State} state */
function outcomeOf({update, isFollowed, failure}) {
  const version = update.update_version ? `to ${update.update_version} ` : '';
  if (failure) {
    return {tone: 'bad', title: 'The update was not installed', detail: failure};
  }
  switch (update.state) {
    case 'failed':
      return {tone: 'bad', title: 'The update was not installed', detail: `${sentence(update.error)} Nothing was changed.`.trim()};
    case 'returned':
      return {
        tone: 'warn',
        title: `The update ${version}did not start; the earlier version is back`,
        detail: sentence(update.error) || 'All scans and settings are still there.',
      };
    case 'kept':
      return isFollowed ? {tone: 'good', title: `Octurn ${update.update_version || update.version} is running`, detail: ''} : null;
    default:
      return null;
  }
}

/** What to show. Pure. @param {State} state */
export function shownOf(state) {
  const phase = phaseOf(state);
  const now = phase ? phases.indexOf(phase) : -1;
  return {
    phase,
    summary: phase ? `${words[phase]}…` : `Octurn ${state.update.version} is in use.`,
    text: textOf(phase, state),
    steps: phases.map((name, index) => ({name, state: index < now ? 'done' : index === now ? 'now' : 'next'})),
    progress: phase === 'sending' && state.sending ? state.sending.sent / state.sending.total : null,
    outcome: phase ? null : outcomeOf(state),
    hint: state.isScanning ? 'A scan is running. Install the update after it.' : '',
  };
}

/** Why a file can be no update, or nothing. Pure. @param {number} size  bytes */
export function complaintOf(size) {
  return size === 0 ? 'This file is empty.' :
    size > mostBytes ? `This is no update: it has ${bytes(size)}, and an update has at most ${bytes(mostBytes)}.` : '';
}

/** @type {State} */
let state = {
  update: {version: '', slot: '', state: 'none', update_version: '', error: ''},
  sending: null, isScanning: false, isAway: false, isFollowed: false, failure: '',
};

/** @type {AbortController | null} */
let upload = null;

const chosenFile = () => /** @type {File | undefined} */ (element('update-file').files[0]);

function showChoice() {
  const file = chosenFile();
  const complaint = file ? complaintOf(file.size) : '';
  show(element('update-chosen'), file !== undefined);
  show(element('update-install'), file !== undefined);
  show(element('update-older'), file !== undefined);
  setText(part(element('update-pick'), 'span'), file ? 'Choose another file' : 'Choose a file');
  setText(part(element('update-chosen'), 'strong'), file?.name ?? '');
  setText(part(element('update-chosen'), 'span'), file ? complaint || bytes(file.size) : '');
  element('update-install').setAttribute('aria-disabled', String(complaint !== '' || state.isScanning || state.isAway));
}

function render() {
  const {phase, summary, text, steps, progress, outcome, hint} = shownOf(state);
  setText(element('update-summary'), summary);
  show(element('update-choice'), phase === null);
  show(element('update-going'), phase !== null);
  showChoice();
  setText(element('update-hint'), hint);
  for (const step of steps) {
    part(element('update-steps'), `[data-step=${step.name}]`).dataset.state = step.state;
  }
  const bar = element('update-progress');
  if (progress === null) {
    bar.removeAttribute('value');  // it goes on, and nobody knows how far
  } else {
    bar.value = progress;
  }
  setText(element('update-text'), text);
  show(element('update-cancel'), state.sending !== null);
  show(element('update-outcome'), outcome !== null);
  if (outcome) {
    element('update-outcome').dataset.tone = outcome.tone;
    setText(part(element('update-outcome'), 'strong'), outcome.title);
    setText(part(element('update-outcome'), 'p'), outcome.detail);
  }
}

/** @param {Partial<State>} news */
function change(news) {
  state = {...state, ...news};
  const phase = phaseOf(state);
  if (phase && phase !== 'sending' && !state.isFollowed) {
    sessionStorage.setItem(mark, 'seen');
    state.isFollowed = true;
  }
  render();
}

/** @param {Update} update */
export function showUpdate(update) {
  if (state.update.version && state.update.version !== update.version) {
    location.reload();  // the page is of the version before
  }
  if (update.state === 'kept') {
    sessionStorage.removeItem(mark);
  }
  change({update, isAway: false});
}

export const showUpdateAway = () => change({isAway: true});

/** @param {boolean} isScanning */
export const showScanning = (isScanning) => change({isScanning});

/** What to say while the scanner does not answer, or null. */
export function updateAway() {
  const phase = phaseOf(state);
  return phase === 'restarting' || phase === 'trial' ? {title: 'The scanner starts again.', text: textOf('restarting', state)} : null;
}

/** Whether news are expected soon. */
export const isUpdating = () => phaseOf(state) !== null;

async function install() {
  const file = chosenFile();
  if (!file || element('update-install').getAttribute('aria-disabled') === 'true') {
    return;
  }
  upload = new AbortController();
  const {signal} = upload;
  change({failure: '', isFollowed: false, sending: {sent: 0, total: file.size}});
  element('update-cancel').focus({preventScroll: true});
  try {
    const update = await api.sendUpdate(file, (sent) => change({sending: {sent, total: file.size}}), signal,
      part(element('update-older'), 'input').checked);
    element('update-file').value = '';
    part(element('update-older'), 'input').checked = false;
    change({sending: null, update});
  } catch (error) {
    const {title, detail, hint} = error instanceof api.Problem ? error : new api.Problem('page', String(error));
    change({sending: null, failure: signal.aborted ? '' : [detail || title, hint].map(sentence).join(' ')});
  }
}

export function prepareUpdate() {
  state.isFollowed = sessionStorage.getItem(mark) !== null;
  element('update-file').addEventListener('change', () => change({failure: ''}));
  element('update-install').addEventListener('click', install);
  element('update-cancel').addEventListener('click', () => upload?.abort());
}
