// Notes that this browser keeps, if its storage is allowed. Without storage, a note holds until the page is closed.

/** @typedef {'localStorage' | 'sessionStorage'} Kind */

/** @type {Map<string, string>} */
const held = new Map();

/** @param {string} key @param {Kind} [kind] @returns {string | null} */
export function noted(key, kind = 'localStorage') {
  try {
    return globalThis[kind].getItem(key);
  } catch {
    return held.get(key) ?? null;
  }
}

/** @param {string} key @param {string} [value] @param {Kind} [kind] */
export function note(key, value = 'yes', kind = 'localStorage') {
  try {
    globalThis[kind].setItem(key, value);
  } catch {
    held.set(key, value);
  }
}

/** @param {string} key @param {Kind} [kind] */
export function forget(key, kind = 'localStorage') {
  try {
    globalThis[kind].removeItem(key);
  } catch {
    held.delete(key);
  }
}
