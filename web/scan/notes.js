// "Notes" on a scan and the rest of its label, each saved when its field loses focus.

import {Problem, label} from '../api/api.js';
import {element, setText} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {awaitFragment} from '../base/fragment.js';
import {knownTags, tagsIn} from '../library/library.js';
import {change, state} from '../page.js';
import {scanOf, withScan} from '../state.js';
import {text} from '../base/texts.js';

/** @typedef {'notes' | 'tags' | 'inventory_number' | 'author' | 'licence'} Key */

let isHere = false;  // whether the fragment is loaded
/** The scan whose label is in the fields. @type {string | null} */
let shown = null;

const fields = () => /** @type {HTMLInputElement[]} */ ([...element('notes-field').querySelectorAll('[data-label]')]);

/** @param {string} words @param {'good' | 'bad' | ''} tone */
function say(words, tone) {
  setText(element('notes-said'), words);
  element('notes-said').dataset.tone = tone;
}

/** Fills the fields for the scan in view, except the one in which somebody is writing. */
export function showNotes() {
  const scan = scanOf(state, state.selected);
  if (!isHere || !scan) {
    return;
  }
  const isOther = scan.id !== shown;
  if (isOther) {
    say('', '');
  }
  shown = scan.id;
  for (const field of fields()) {
    if (isOther || document.activeElement !== field) {
      const value = scan[/** @type {Key} */ (field.dataset.label)];
      field.value = typeof value === 'string' ? value : value.join(', ');
    }
  }
  element('known-tags').replaceChildren(...knownTags(state.scans).map((tag) => new Option(tag)));
}

/** @param {Event} event */
async function keep({target}) {
  const field = /** @type {HTMLInputElement} */ (target);
  const key = field.dataset.label ?? '';
  const id = /** @type {string} */ (shown);
  try {
    const scan = await label(id, {[key]: key === 'tags' ? tagsIn(field.value) : field.value.trim()});
    change(withScan(state, scan));
    if (shown === id) {
      say(text('saved'), 'good');
    }
  } catch (error) {
    const {detail, hint} = error instanceof Problem ? error : new Problem('page', String(error), String(error));
    say([text('notes.failed'), detail, hint].filter(Boolean).map(sentence).join(' '), 'bad');
  }
}

/** Fetches the fields, and attaches their handler. */
export async function prepareNotes() {
  await awaitFragment(element('notes-field'), 'notes.html');
  fields().forEach((field) => field.addEventListener('change', keep));
  isHere = true;
  showNotes();
}
