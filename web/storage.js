// Notes that this browser keeps, if its storage is allowed.

/** @param {string} key */
export function noted(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Without storage, a note holds until the page is closed. @param {string} key @param {string} [value] */
export function note(key, value = 'yes') {
  try {
    localStorage.setItem(key, value);
  } catch {
    // the page's own state has it
  }
}
