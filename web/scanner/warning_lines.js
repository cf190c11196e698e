// Warnings about the computer, one line each. They can be dismissed until they change.

import {element, list, part, setText, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {note, noted} from '../base/storage.js';
import {text, translated} from '../base/texts.js';

/** @typedef {import('../api/api.js').Finding} Finding */

const tones = /** @type {Record<string, string>} */ ({fault: 'bad', warning: 'warn'});
const dismissedKey = 'octurn-dismissed-warnings';

/** The text of a warning. Pure. @param {Finding} finding */
export const textOf = ({name, measured, advice}) => ({title: `${translated(name)}: ${translated(measured)}.`, text: sentence(advice)});

/** What a dismissal holds for: the warning, whatever its numbers. Pure. @param {Finding} finding */
export const kindOf = ({check, state, measured}) => `${check} ${state} ${measured.replace(/[\d.]+/g, '')}`;

/** @returns {string[]} the kinds of the dismissed warnings */
function readDismissed() {
  try {
    return JSON.parse(noted(dismissedKey) ?? '[]').map(String);
  } catch {
    return [];
  }
}

let dismissed = readDismissed();

/** @param {string[]} kinds */
function dismiss(kinds) {
  dismissed = kinds;
  note(dismissedKey, JSON.stringify(kinds));
}

/** @type {Finding[]} */
let warnings = [];

function render() {
  const shown = warnings.filter((finding) => !dismissed.includes(kindOf(finding)));
  show(element('warnings'), shown.length > 0);
  list(element('warnings'), shown, kindOf, 'machine-warning', (item, finding) => {
    const {title, text: advice} = textOf(finding);
    item.dataset.tone = tones[finding.state] ?? '';
    setText(part(item, 'strong'), title);
    setText(part(item, 'span'), advice);
    part(item, '.icon-button').setAttribute('aria-label', text('library.action', {action: text('dismiss'), name: translated(finding.name)}));
  });
}

function listen() {
  element('warnings').addEventListener('click', (/** @type {any} */ event) => {
    const line = event.target.closest('.warning-line');
    const item = event.target.closest('.icon-button')?.closest('li');
    if (line) {
      line.setAttribute('aria-expanded', String(line.getAttribute('aria-expanded') !== 'true'));
    } else if (item) {
      dismiss([...dismissed, item.dataset.key]);
      render();
      (part(element('warnings'), '.icon-button') ?? part(document, 'main:not([hidden]) [tabindex="-1"]'))?.focus({preventScroll: true});
    }
  });
}

let isListening = false;

/** @param {Finding[]} told  by the scanner, except those that are none in this browser */
export function showWarnings(told) {
  if (!isListening) {
    isListening = true;
    listen();
  }
  warnings = told;
  const kinds = warnings.map(kindOf);
  if (!dismissed.every((kind) => kinds.includes(kind))) {
    dismiss(dismissed.filter((kind) => kinds.includes(kind)));  // a warning that ended is shown when it returns
  }
  render();
}
