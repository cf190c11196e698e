// The places of the page: Scan, Library and Scanner; Calibrate and Settings are parts of Scanner. Each but the first has the address
// '#' and its name, and a module and an HTML fragment that are fetched at the first visit.

import {element, setText, show} from './base/dom.js';
import {fetchFragment} from './base/fragment.js';
import {text} from './base/texts.js';

const first = 'scan';

/** @type {Record<string, {title: string, load: () => Promise<{prepare: () => void}>, piece?: string}>} piece: the id of the fragment's
 * container and its file's name; by default those of the whole place */
const others = {
  library: {title: 'places.library', load: () => import('./library/library_page.js')},
  scanner: {title: 'places.scanner', load: () => import('./scanner/scanner_page.js'), piece: 'doctor'},
  calibrate: {title: 'places.calibrate', load: () => import('./scanner/calibrate.js')},
  settings: {title: 'places.settings', load: () => import('./scanner/settings_page.js')},
};

const betweenAttempts = 2000;  // milliseconds between attempts to load a place

/** @param {string} hash  of an address, without '#' @returns {string} the named place; any other hash names a scan */
export const placeOf = (hash) => Object.hasOwn(others, hash) ? hash : first;

/** @param {string} place @param {string} title  of the first place @returns {string} the document's title */
export const titleAt = (place, title) => place === first ? title : `${text(others[place].title)} · Octurn`;

/** @returns {string} the current place */
export const here = () => placeOf(location.hash.slice(1));

const mainOf = (/** @type {string} */ place) => /** @type {HTMLElement} */ (document.querySelector(`main[data-place=${place}]`));

/** @type {Set<string>} places that are loaded or loading */
const begun = new Set();

/** @param {string} place */
async function arrive(place) {
  if (!Object.hasOwn(others, place) || begun.has(place)) {
    return;
  }
  begun.add(place);
  const {load, piece} = others[place];
  const parent = piece ? element(piece) : mainOf(place);
  parent.setAttribute('aria-busy', 'true');
  try {
    const loading = load();
    const [module] = await Promise.all([loading, fetchFragment(parent, `${piece ?? place}.html`, loading)]);
    module.prepare();
  } catch {
    begun.delete(place);
    setText(parent, text('places.late'));
    setTimeout(() => here() === place && arrive(place), betweenAttempts);
  } finally {
    parent.removeAttribute('aria-busy');
  }
}

const parts = new Set(['scanner', 'calibrate', 'settings']);

/** The tab of an address; scans belong to the library. @param {string} hash @returns {string} */
export const tabOf = (hash) => parts.has(hash) ? 'scanner' : hash === '' ? first : 'library';

/** @param {string} links @param {string} name  of the current one */
function markCurrent(links, name) {
  for (const link of document.querySelectorAll(`${links} a`)) {
    const isCurrent = /** @type {HTMLElement} */ (link).dataset.to === name;
    isCurrent ? link.setAttribute('aria-current', 'page') : link.removeAttribute('aria-current');
  }
}

let shown = first;
let libraryScroll = 0;  // pixels from the top, when it was left

/** Shows the place in the address. If it changed, scrolls to the top, but in the library to where it was left. */
export function showPlace() {
  const place = here();
  if (shown === 'library' && place !== shown) {
    libraryScroll = window.scrollY;
  }
  for (const main of document.querySelectorAll('main')) {
    show(main, main.dataset.place === place);
  }
  if (place !== shown) {
    shown = place;
    window.scrollTo(0, place === 'library' ? libraryScroll : 0);
  }
  markCurrent('.places', tabOf(location.hash.slice(1)));
  markCurrent('.parts', place);
  show(/** @type {Element} */ (document.querySelector('.parts')), parts.has(place));
  arrive(place);
}

/** Attaches the handler of the skip link. */
export function preparePlaces() {
  element('skip').addEventListener('click', (/** @type {Event} */ event) => {
    event.preventDefault();  // the address must keep the place
    /** @type {HTMLElement | null} */ (mainOf(here()).querySelector('[tabindex="-1"]'))?.focus();
  });
}
