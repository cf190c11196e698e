// "Power" in the settings: restart, shutdown, and the program's log.

import {Problem, json, sending, status} from '../api/api.js';
import {element, setText, show} from '../base/dom.js';
import {fetchFragment} from '../base/fragment.js';
import {sentence} from '../base/format.js';
import {text} from '../base/texts.js';


/** The lines of the log to show, without their priority prefix. Pure. @param {{log: string[], errors: string[]}} messages */
export const linesOf = ({log, errors}) => [...errors, ...log].map((line) => line.replace(/<\d>/, '')).join('\n');

/** @param {HTMLElement} button */
async function end(button) {
  setText(element('power-complaint'), '');
  if (button.dataset.sure !== 'yes') {
    button.dataset.sure = 'yes';
    setText(button, button.dataset.power === 'restart' ? text('power.restart-now') : text('power.shutdown-now'));
    return;
  }
  try {
    await json(`machine/${button.dataset.power}`, sending('POST'));
    setText(element('power-said'), button.dataset.power === 'restart' ? text('power.restarts') : text('power.shuts-down'));
    show(element('power-actions'), false);
  } catch (error) {
    const {detail, title, hint} = error instanceof Problem ? error : new Problem('page', String(error));
    setText(element('power-complaint'), [detail || title, hint].map(sentence).join(' ').trim());
  }
}

async function showMessages() {
  if (element('messages').open) {
    const messages = await json('messages').catch((/** @type {Error} */ error) => ({log: [String(error)], errors: []}));
    setText(element('message-lines'), linesOf(messages));
  }
}

/** Replaces #power by the card. */
export async function preparePower() {
  await fetchFragment(element('power'), 'power.html');
  element('power').replaceWith(...element('power').childNodes);
  element('power-actions').addEventListener('click', (/** @type {any} */ event) => event.target.closest('button') && end(event.target.closest('button')));
  element('messages').addEventListener('toggle', showMessages);
  const isAppliance = Boolean((await status().catch(() => null))?.appliance);
  show(element('power-actions'), isAppliance);
  show(element('power-head'), isAppliance);
}
