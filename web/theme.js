// Applies the theme of the settings (base/theme.js) before anything is drawn. Without one, the browser's theme applies.
try {
  const theme = localStorage.getItem('octurn-theme');
  if (theme) {
    document.documentElement.dataset.theme = theme;
    for (const meta of document.querySelectorAll('meta[name=theme-color]')) {
      meta.dataset.media = meta.media;
      meta.media = meta.media.includes(theme) ? '' : 'not all';
    }
  }
} catch {  // the browser blocks storage
}
