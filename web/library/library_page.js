// The library: finds, chooses, names, deletes, restores and imports scans.

import {prepareBin} from '../scan/bin.js';
import {element} from '../base/dom.js';
import {note, noted} from '../base/storage.js';
import * as library from './library.js';
import {showLibrary} from './library_view.js';
import {change, state} from '../page.js';
import {emptyBin, importScan, remove, removeChosen, rename, restore} from '../scan/scan_actions.js';
import * as states from '../state.js';

const memory = 'octurn-search';  // storage key of the search, until the tab is closed

/** Attaches the handlers of library.html. */
export function prepare() {
  const click = (/** @type {string} */ id, /** @type {() => void} */ action) => element(id).addEventListener('click', action);
  const query = element('library-query');
  query.value = noted(memory, 'sessionStorage') ?? '';
  query.addEventListener('input', () => {
    note(memory, query.value, 'sessionStorage');
    change(states.withLibrary(state, {query: query.value, limit: library.step}));
  });
  element('library-order').addEventListener('change', (/** @type {any} */ event) =>
    change(states.withLibrary(state, {order: event.target.value})));
  element('import').addEventListener('change', (/** @type {any} */ event) => {
    const [file] = event.target.files;
    event.target.value = '';
    file && importScan(file);
  });
  click('show-more', () => change(states.withLibrary(state, {limit: state.library.limit + library.step})));
  click('choose', () => change(states.withLibrary(state, {chosen: state.library.chosen ? null : []})));
  click('delete-chosen', removeChosen);
  element('rows').addEventListener('change', (/** @type {any} */ event) => {
    if (event.target.type === 'checkbox') {
      change({...state, library: library.withToggled(state.library, event.target.closest('.scan').dataset.key)});
    }
  });
  element('rows').addEventListener('click', (/** @type {any} */ event) => {
    const id = event.target.closest('.scan').dataset.key;
    const what = event.target.closest('[data-do]')?.dataset.do;
    if (what === 'rename') {
      rename(id);
    } else if (what === 'delete') {
      const card = event.target.closest('.scan');
      const next = card.nextElementSibling ?? card.previousElementSibling;
      remove(id).then(() => card.isConnected ||
        (next?.isConnected ? /** @type {HTMLElement} */ (next.querySelector('.scan-name')) : element('library-query')).focus());
    }
  });
  prepareBin({restore: (id) => restore([id]), empty: emptyBin});
  showLibrary();
  change(states.withLibrary(state, {query: query.value}));
}
