// Pieces of the page that are fetched when they are needed: HTML files without head and body.

import {awaitTexts, fillTexts} from './texts.js';

const betweenAttempts = 2000;  // milliseconds, while a piece does not arrive

/** @type {Map<string, Promise<unknown>>} stylesheets that pieces asked for, by their addresses */
const styles = new Map();

/** Adds the stylesheets of a piece to the page. @param {Document} piece */
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

/** @param {Element} parent  whose children become those of the file @param {string} file */
export async function fetchFragment(parent, file) {
  const response = await fetch(file, {cache: 'no-cache'});
  if (!response.ok) {
    throw new Error(`${response.status}`);
  }
  const parsed = new DOMParser().parseFromString(await response.text(), 'text/html');
  await Promise.all([awaitStyles(parsed), awaitTexts()]);
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
