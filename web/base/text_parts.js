// The texts that the page's first view does not need: those of places and fragments that are fetched later. Their keys begin with
// one of these words.

const later = new Set(['action', 'bin', 'box-side', 'builds', 'calibrate', 'check', 'choice', 'figure', 'finding', 'fit', 'keys', 'lens', 'machine', 'map', 'notes', 'optics', 'outgoing', 'placement', 'pose',
  'power', 'reason', 'run', 'scale', 'setting', 'setting-help', 'settings', 'turn', 'update', 'warm', 'wifi']);

/** @param {string} key */
export const isLater = (key) => later.has(key.split('.')[0]);
