// The library: finds, chooses, names, deletes, restores and imports scans.

import * as api from '../api/api.js';
import {prepareBin} from '../scan/bin.js';
import {element} from '../base/dom.js';
import {note, noted} from '../base/storage.js';
import * as library from './library.js';
import {renderLibrary} from './library_view.js';
import {act, change, state} from '../page.js';
import {screenOf} from '../screen.js';
import {emptyBin, importScan, remove, removeChosen, rename, restore, tagChosen} from '../scan/scan_actions.js';
import * as states from '../state.js';
import {showLibrary} from '../view.js';

const memory = 'octurn-search';  // storage key of the search, until the tab is closed

/** Shows the scans that match a text. @param {string} query */
function search(query) {
  element('library-query').value = query;
  note(memory, query, 'sessionStorage');
  change(states.withLibrary(state, {query, limit: library.step}));
}

/** Downloads the models of the chosen scans, or shows why the scanner refuses that. */
const downloadZip = () => act('failure.zip', async () => {
  const address = element('chosen-zip').getAttribute('href');
  await api.expectFile(address);
  Object.assign(document.createElement('a'), {href: address, download: ''}).click();
  return (now) => now;
});

/** The handlers for the chosen scans. */
function listenForChosen() {
  element('choose-all').addEventListener('click', () =>
    change({...state, library: library.withAll(state.library, screenOf(state).found)}));
  element('chosen-format').addEventListener('change', () => change(state));
  element('delete-chosen').addEventListener('click', removeChosen);
  element('tag-form').addEventListener('submit', async (/** @type {Event} */ event) => {
    event.preventDefault();
    const field = element('tag-chosen');
    if (state.library.chosen?.length && field.value.trim()) {
      await tagChosen(field.value.trim());
      field.value = '';
    }
  });
  element('chosen-csv').addEventListener('click', (/** @type {Event} */ event) =>
    state.library.chosen?.length || event.preventDefault());
  element('chosen-zip').addEventListener('click', (/** @type {Event} */ event) => {
    event.preventDefault();
    state.library.chosen?.length && downloadZip();
  });
}

/** Attaches the handlers of library.html. */
export function prepare() {
  const click = (/** @type {string} */ id, /** @type {() => void} */ action) => element(id).addEventListener('click', action);
  const query = element('library-query');
  query.value = noted(memory, 'sessionStorage') ?? '';
  query.addEventListener('input', () => search(query.value));
  element('library-order').addEventListener('change', (/** @type {any} */ event) =>
    change(states.withLibrary(state, {order: event.target.value})));
  element('import').addEventListener('change', (/** @type {any} */ event) => {
    const [file] = event.target.files;
    event.target.value = '';
    file && importScan(file);
  });
  click('show-more', () => change(states.withLibrary(state, {limit: state.library.limit + library.step})));
  click('choose', () => change(states.withLibrary(state, {chosen: state.library.chosen ? null : []})));
  listenForChosen();
  element('rows').addEventListener('change', (/** @type {any} */ event) => {
    if (event.target.type === 'checkbox') {
      change({...state, library: library.withToggled(state.library, event.target.closest('.scan').dataset.key)});
    }
  });
  element('rows').addEventListener('click', (/** @type {any} */ event) => {
    const id = event.target.closest('.scan').dataset.key;
    const what = event.target.closest('[data-do]')?.dataset.do;
    if (what === 'tag') {
      search(event.target.textContent);
    } else if (what === 'rename') {
      rename(id);
    } else if (what === 'delete') {
      const card = event.target.closest('.scan');
      const next = card.nextElementSibling ?? card.previousElementSibling;
      remove(id).then(() => card.isConnected ||
        (next?.isConnected ? /** @type {HTMLElement} */ (next.querySelector('.scan-name')) : element('library-query')).focus());
    }
  });
  prepareBin({restore: (id) => restore([id]), empty: emptyBin});
  showLibrary(renderLibrary);
  change(states.withLibrary(state, {query: query.value}));
}
