// "Update": uploads a file to the scanner, and shows the update's progress across the restart.

import * as api from '../api/api.js';
import {element, part, setText, setVerbatim, show} from '../base/dom.js';
import {bytes, sentence} from '../base/format.js';
import {forget, note, noted} from '../base/storage.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api.js').Update} Update */

/**
 * @typedef {Object} State
 * @property {Update} update  last reported by the scanner
 * @property {{sent: number, total: number} | null} sending  bytes of this page's upload
 * @property {boolean} isScanning
 * @property {boolean} isAway  whether the scanner does not answer
 * @property {boolean} isFollowed  whether this page saw the update start
 * @property {string} failure  why the last file was refused, or empty
 */

const mostBytes = 160 * 2 ** 20;
const mark = 'octurn-update';  // session storage key: an update was seen to start before the page was reloaded

const phases = /** @type {const} */ (['sending', 'installing', 'restarting', 'trial']);

/** The current phase. Pure. @param {State} state @returns {typeof phases[number] | null} */
export function phaseOf({update, sending, isAway, isFollowed}) {
  const phase = phases.find((name) => name === update.state) ?? null;
  if (sending || update.state === 'receiving') {
    return 'sending';
  }
  return isFollowed && isAway && phase === 'installing' ? 'restarting' : phase;
}

/** @param {ReturnType<typeof phaseOf>} phase @param {State} state */
function textOf(phase, {sending}) {
  switch (phase) {
    case 'sending': return sending ? text('count.of', {done: bytes(sending.sent), total: bytes(sending.total)}) : text('update.elsewhere');
    case 'installing': return text('update.installing-about');
    case 'restarting': return text('update.restarting-about');
    case 'trial': return text('update.trial-about');
    default: return '';
  }
}

/** @param {State} state */
function outcomeOf({update, isFollowed, failure}) {
  if (failure) {
    return {tone: 'bad', title: text('update.failed'), detail: failure};
  }
  switch (update.state) {
    case 'failed':
      return {tone: 'bad', title: text('update.failed'), detail: `${sentence(update.error)} ${text('update.unchanged')}`.trim()};
    case 'returned':
      return {
        tone: 'warn',
        title: text(update.update_version ? 'update.returned-version' : 'update.returned', {version: update.update_version}),
        detail: sentence(update.error) || text('update.returned-about'),
      };
    case 'kept':
      return isFollowed ? {tone: 'good', title: text('update.kept', {version: update.update_version || update.version}), detail: ''} : null;
    default:
      return null;
  }
}

/** The view of an update. Pure. @param {State} state */
export function shownOf(state) {
  const phase = phaseOf(state);
  const now = phase ? phases.indexOf(phase) : -1;
  return {
    phase,
    summary: phase ? text(`update.${phase}`) : text('update.in-use', {version: state.update.version}),
    text: textOf(phase, state),
    steps: phases.map((name, index) => ({name, state: index < now ? 'done' : index === now ? 'now' : 'next'})),
    progress: phase === 'sending' && state.sending ? state.sending.sent / state.sending.total : null,
    outcome: phase ? null : outcomeOf(state),
    hint: state.isScanning ? text('update.scanning') : '',
  };
}

/** Why a file cannot be an update, or an empty text. Pure. @param {number} size  bytes */
export function complaintOf(size) {
  return size === 0 ? text('update.empty') :
    size > mostBytes ? text('update.too-large', {bytes: bytes(size), most: bytes(mostBytes)}) : '';
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
  setText(part(element('update-pick'), 'span'), text(file ? 'update.pick-another' : 'update.pick'));
  setVerbatim(part(element('update-chosen'), 'strong'), file?.name ?? '');
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
    bar.removeAttribute('value');  // indeterminate
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
    note(mark, 'seen', 'sessionStorage');
    state.isFollowed = true;
  }
  render();
}

/** @param {Update} update */
export function showUpdate(update) {
  if (update.state === 'kept') {
    forget(mark, 'sessionStorage');
  }
  change({update, isAway: false});
}

export const showUpdateAway = () => change({isAway: true});

/** @param {boolean} isScanning */
export const showScanning = (isScanning) => change({isScanning});

/** The explanation why the scanner does not answer, or null. */
export function updateAway() {
  const phase = phaseOf(state);
  return phase === 'restarting' || phase === 'trial' ? {title: text('update.away'), text: textOf('restarting', state)} : null;
}

/** Whether changes are expected soon. */
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
  state.isFollowed = noted(mark, 'sessionStorage') !== null;
  element('update-file').addEventListener('change', () => change({failure: ''}));
  element('update-install').addEventListener('click', install);
  element('update-cancel').addEventListener('click', () => upload?.abort());
}
