// The places of the page: Scan, Library and Scanner, of which Calibrate and Settings are parts. Each but the first has an
// address, '#' and its name, and a module and a piece of HTML, which are fetched when somebody first goes there.

import {element, setText, show} from './dom.js';
import {fetchFragment} from './fragment.js';
import {text} from './texts.js';

const first = 'scan';

/** @type {Record<string, {title: string, load: () => Promise<{prepare: () => void}>, piece?: string}>} piece: the id of what it is put
 * into, and its file's name; without it, the whole place's */
const others = {
  library: {title: 'places.library', load: () => import('./library_page.js')},
  scanner: {title: 'places.scanner', load: () => import('./scanner_page.js'), piece: 'doctor'},
  calibrate: {title: 'places.calibrate', load: () => import('./calibrate.js')},
  settings: {title: 'places.settings', load: () => import('./settings_page.js')},
};

const betweenAttempts = 2000;  // milliseconds, while a part does not arrive

/** @param {string} hash  of an address, without '#' @returns {string} the part that it names; every other names a scan */
export const placeOf = (hash) => Object.hasOwn(others, hash) ? hash : first;

/** @param {string} place @param {string} title  of the first part @returns {string} the document's */
export const titleAt = (place, title) => place === first ? title : `${text(others[place].title)} · Octurn`;

/** @returns {string} the part that is shown */
export const here = () => placeOf(location.hash.slice(1));

const mainOf = (/** @type {string} */ place) => /** @type {HTMLElement} */ (document.querySelector(`main[data-place=${place}]`));

/** @type {Set<string>} of places that have arrived, or are on their way */
const begun = new Set();

/** @param {string} place */
async function arrive(place) {
  if (!Object.hasOwn(others, place) || begun.has(place)) {
    return;
  }
  begun.add(place);
  const {load, piece} = others[place];
  const parent = piece ? element(piece) : mainOf(place);
  try {
    const [module] = await Promise.all([load(), fetchFragment(parent, `${piece ?? place}.html`)]);
    module.prepare();
  } catch {
    begun.delete(place);
    setText(parent, text('places.late'));
    setTimeout(() => here() === place && arrive(place), betweenAttempts);
  }
}

const parts = new Set(['scanner', 'calibrate', 'settings']);

/** Which of the three places an address belongs to: that of a scan is one of the library. @param {string} hash @returns {string} */
export const tabOf = (hash) => parts.has(hash) ? 'scanner' : hash === '' ? first : 'library';

/** @param {string} links @param {string} name  of the one that is current */
function markCurrent(links, name) {
  for (const link of document.querySelectorAll(`${links} a`)) {
    const isCurrent = /** @type {HTMLElement} */ (link).dataset.to === name;
    isCurrent ? link.setAttribute('aria-current', 'page') : link.removeAttribute('aria-current');
  }
}

let shown = first;

/** Shows the part that the address names, another one from its top on. */
export function showPlace() {
  const place = here();
  if (place !== shown) {
    shown = place;
    window.scrollTo(0, 0);
  }
  for (const main of document.querySelectorAll('main')) {
    show(main, main.dataset.place === place);
  }
  markCurrent('.places', tabOf(location.hash.slice(1)));
  markCurrent('.parts', place);
  show(/** @type {Element} */ (document.querySelector('.parts')), parts.has(place));
  arrive(place);
}

/** Makes the link work that skips what every part has. */
export function preparePlaces() {
  element('skip').addEventListener('click', (/** @type {Event} */ event) => {
    event.preventDefault();  // the address is the part's
    /** @type {HTMLElement | null} */ (mainOf(here()).querySelector('[tabindex="-1"]'))?.focus();
  });
}
