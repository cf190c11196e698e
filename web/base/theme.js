// The theme chosen in the settings. theme.js shows it, also when a document is opened.

import {forget, note, noted} from './storage.js';

const memory = 'octurn-theme';  // storage key, which theme.js reads

/** @returns {string | null} "light" or "dark"; null: the browser's */
export const chosenTheme = () => noted(memory);

/** @param {string | null} theme  "light" or "dark"; null: the browser's */
export function chooseTheme(theme) {
  theme === null ? forget(memory) : note(memory, theme);
  /** @type {any} */ (globalThis).showTheme(theme);
}
