// Pieces of the page that are fetched when they are needed: HTML files without head and body.

import {fillTexts} from './texts.js';

const betweenAttempts = 2000;  // milliseconds, while a piece does not arrive

/** @param {Element} parent  whose children become those of the file @param {string} file */
export async function fetchFragment(parent, file) {
  const response = await fetch(file, {cache: 'no-cache'});
  if (!response.ok) {
    throw new Error(`${response.status}`);
  }
  const parsed = new DOMParser().parseFromString(await response.text(), 'text/html');
  fillTexts(parsed);
  parent.replaceChildren(...parsed.head.childNodes, ...parsed.body.childNodes);
}

/** The same, again and again until it is there. @param {Element} parent @param {string} file */
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
