// Fragments of the page, fetched when they are needed: HTML files without head and body.

import {fillTexts} from './texts.js';

const betweenAttempts = 2000;  // milliseconds between attempts to fetch a fragment

/** @type {Map<string, Promise<unknown>>} stylesheets of fragments, by URL */
const styles = new Map();

/** Adds a fragment's stylesheets to the page. @param {Document} piece */
const awaitStyles = (piece) => Promise.all([...piece.querySelectorAll('link')].map((link) => {
  const address = link.getAttribute('href') ?? '';
  link.remove();
  if (!styles.has(address)) {
    styles.set(address, new Promise((done, fail) => {
      link.onload = done;
      link.onerror = () => {
        styles.delete(address);
        link.remove();
        fail(new Error(address));
      };
      document.head.append(link);
    }));
  }
  return styles.get(address);
}));

/**
 * Replaces an element's children by a fragment.
 * @param {Element} parent @param {string} file
 * @param {Promise<unknown>} [handlers]  the module that attaches the fragment's handlers; nothing is shown before it is loaded,
 *     or a click could be lost
 */
export async function fetchFragment(parent, file, handlers) {
  const response = await fetch(file, {cache: 'no-cache'});
  if (!response.ok) {
    throw new Error(`${response.status}`);
  }
  const parsed = new DOMParser().parseFromString(await response.text(), 'text/html');
  await Promise.all([awaitStyles(parsed), handlers]);
  fillTexts(parsed);
  parent.replaceChildren(...parsed.head.childNodes, ...parsed.body.childNodes);
}

/** Like fetchFragment, but retries until it succeeds. @param {Element} parent @param {string} file */
export async function awaitFragment(parent, file) {
  for (;;) {
    try {
      return await fetchFragment(parent, file);
    } catch {
      await new Promise((done) => {
        setTimeout(done, betweenAttempts);
      });
    }
  }
}
