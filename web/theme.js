// Applies the theme of the settings (base/theme.js) before anything is drawn.

/** @param {string | null} theme  "light" or "dark"; null: the browser's */
globalThis.showTheme = (theme) => {
  if (theme) {
    document.documentElement.dataset.theme = theme;
  } else {
    delete document.documentElement.dataset.theme;
  }
  for (const meta of document.querySelectorAll('meta[name=theme-color]')) {
    const own = meta.dataset.media ??= meta.media;
    meta.media = !theme ? own : own.includes(theme) ? '' : 'not all';
  }
};

try {
  showTheme(localStorage.getItem('octurn-theme'));
} catch {  // the browser blocks storage
}
