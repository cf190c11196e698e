// "Notes" on a scan, saved when the field loses focus.

import {Problem, label} from '../api/api.js';
import {element, setText} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {awaitFragment} from '../base/fragment.js';
import {change, state} from '../page.js';
import {scanOf, withScan} from '../state.js';
import {text} from '../base/texts.js';

let isHere = false;  // whether the fragment is loaded
/** The scan whose notes are in the field. @type {string | null} */
let shown = null;

/** @param {string} words @param {'good' | 'bad' | ''} tone */
function say(words, tone) {
  setText(element('notes-said'), words);
  element('notes-said').dataset.tone = tone;
}

/** Fills the field for the scan in view, unless somebody is writing in it. */
export function showNotes() {
  if (!isHere) {
    return;
  }
  const field = element('notes');
  const scan = scanOf(state, state.selected);
  if (scan && (scan.id !== shown || document.activeElement !== field)) {
    if (scan.id !== shown) {
      say('', '');
    }
    shown = scan.id;
    field.value = scan.notes;
  }
}

async function keep() {
  const id = /** @type {string} */ (shown);
  const notes = element('notes').value;
  try {
    const scan = await label(id, {notes});
    change(withScan(state, scan));
    if (shown === id) {
      say(text('saved'), 'good');
    }
  } catch (error) {
    const {detail, hint} = error instanceof Problem ? error : new Problem('page', String(error), String(error));
    say([text('notes.failed'), detail, hint].filter(Boolean).map(sentence).join(' '), 'bad');
  }
}

/** Fetches the field, and attaches its handler. */
export async function prepareNotes() {
  await awaitFragment(element('notes-field'), 'notes.html');
  element('notes').addEventListener('change', keep);
  isHere = true;
  showNotes();
}
