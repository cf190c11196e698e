// "Move the turntable" on the settings page: jogs it, tests it, and offers settings that remedy the test's findings.

import {Problem} from '../api/api.js';
import * as api from '../api/api_settings.js';
import {copyOf, element, part, setText, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {nameOf, valueText} from './settings_form.js';
import {text, translated} from '../base/texts.js';

/** @typedef {import('../api/api_settings.js').TurntableState} TurntableState */
/** @typedef {import('../api/api_settings.js').TurnFinding} TurnFinding */

const pause = 400;  // milliseconds between polls while it moves

/** The view of the turntable. Pure. @param {TurntableState} now */
export function shownOf({state, error, test}) {
  const failure = error ?? (state === 'idle' ? test?.error ?? null : null);
  const isDone = state !== 'testing' && test?.state === 'done';
  const faults = isDone ? test.findings.filter((finding) => finding.state !== 'ok').length : 0;
  const outcome = text(faults === 0 ? 'turn.good' : 'turn.bad');
  return {
    isMoving: state !== 'idle',
    progress: state === 'testing' ? test?.done ?? 0 : null,
    summary: state === 'idle' && isDone ? outcome : state !== 'idle' ? text(`turn.${state}`) : test?.state === 'cancelled' ? text('turn.cancelled') : '',
    trouble: failure ? [failure.detail, failure.hint].map(sentence).join(' ') : '',
    findings: isDone ? test.findings : [],
  };
}

/** The label of a remedy's button, or an empty text. Pure. @param {TurnFinding['set']} set */
export function cureText(set) {
  const [cure] = Object.entries(set);
  return cure ? text('turn.set', {name: nameOf(`turntable.${cure[0]}`), value: valueText(cure[1])}) : '';
}

let isFollowing = false;
/** @type {TurntableState | null} */
let known = null;
let commands = 0;  // number sent: a state that was requested before the last of them is out of date

/** @param {boolean} isMoving  or is about to move */
function disableMoves(isMoving) {
  for (const button of element('turn-moves').querySelectorAll('button')) {
    button.setAttribute('aria-disabled', String(isMoving));
  }
}

/** @param {TurnFinding} finding @param {(set: Object) => Promise<boolean>} onSet */
function itemOf(finding, onSet) {
  const item = copyOf('turn-check');
  item.dataset.state = finding.state;
  part(item, 'use').setAttribute('href', `icons/symbols.svg#${finding.state}`);
  setText(part(item, '.turn-name'), translated(finding.name));
  setText(part(item, '.turn-measured'), sentence(finding.measured));
  setText(part(item, '.turn-advice'), sentence(finding.advice));
  const cure = part(item, 'button');
  show(cure, cureText(finding.set) !== '');
  setText(cure, cureText(finding.set));
  cure.addEventListener('click', async () => {
    if (await onSet(finding.set)) {
      show(cure, false);
      setText(part(item, '.turn-advice'), text('turn.is-set'));
    }
  });
  return item;
}

/** @param {TurntableState} now @param {(set: Object) => Promise<boolean>} onSet */
function render(now, onSet) {
  const {isMoving, progress, summary, trouble, findings} = shownOf(now);
  setText(element('turn-summary'), summary);
  setText(element('turn-trouble'), trouble);
  disableMoves(isMoving);
  show(element('turn-stop'), isMoving);
  show(element('turn-done'), progress !== null);
  element('turn-done').value = progress ?? 0;
  element('turn-checks').replaceChildren(...findings.map((finding) => itemOf(finding, onSet)));
}

/** @param {unknown} error */
function showError(error) {
  const {title, detail, hint} = error instanceof Problem ? error : new Problem('page', String(error));
  setText(element('turn-trouble'), [detail || title, hint].map(sentence).join(' '));
}

/**
 * Shows the turntable's state, unless a command was sent since it was requested.
 * @param {(set: Object) => Promise<boolean>} onSet
 */
async function poll(onSet) {
  const before = commands;
  try {
    const now = await api.turntable();
    if (commands === before) {
      known = now;
      render(now, onSet);
    }
  } catch (error) {
    showError(error);
  }
}

/** Polls until it stands still. @param {(set: Object) => Promise<boolean>} onSet */
async function follow(onSet) {
  if (isFollowing) {
    return;
  }
  isFollowing = true;
  while (known && known.state !== 'idle') {
    await new Promise((done) => {
      setTimeout(done, pause);
    });
    await poll(onSet);
  }
  isFollowing = false;
}

/** @param {(set: Object) => Promise<boolean>} onSet  called to store these turntable settings */
export async function prepareTurntable(onSet) {
  const ask = async (/** @type {Object} */ what) => {
    ++commands;
    disableMoves(true);
    try {
      known = await api.moveTurntable(what);
      render(known, onSet);
      follow(onSet);
    } catch (error) {
      showError(error);
      disableMoves(known !== null && known.state !== 'idle');
    }
  };
  element('turn-moves').addEventListener('click', (/** @type {any} */ {target}) => {
    const button = target.closest('button');
    if (button && button.getAttribute('aria-disabled') !== 'true') {
      ask(button.dataset.jog ? {jog_deg: Number(button.dataset.jog)} : {test: true});
    }
  });
  element('turn-stop').addEventListener('click', () => ask({stop: true}));
  await poll(onSet);
  follow(onSet);
}
