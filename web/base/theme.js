// The theme chosen in the settings. theme.js applies it when a document is opened.

import {forget, note, noted} from './storage.js';

const memory = 'octurn-theme';  // storage key, which theme.js reads

/** @returns {string | null} "light" or "dark"; null: the browser's */
export const chosenTheme = () => noted(memory);

/** @param {string | null} theme  "light" or "dark"; null: the browser's */
export function chooseTheme(theme) {
  const root = document.documentElement;
  if (theme === null) {
    forget(memory);
    delete root.dataset.theme;
  } else {
    note(memory, theme);
    root.dataset.theme = theme;
  }
  for (const meta of document.querySelectorAll('meta[name=theme-color]')) {
    const own = meta.dataset.media ?? meta.media;
    meta.dataset.media = own;
    meta.media = theme === null ? own : own.includes(theme) ? '' : 'not all';
  }
}
