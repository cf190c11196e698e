// The bin below the list of scans: deleted scans, which can be restored.

import * as requests from '../api/api_bin.js';
import {element, list, part, setText, setVerbatim, show} from '../base/dom.js';
import * as format from '../base/format.js';
import {text} from '../base/texts.js';

const undoLasts = 60000;  // milliseconds

let revision = 0;  // of the scans, at the last read of the bin
let timer = 0;

/** @param {requests.Binned} scan @param {Date} now */
export function rowOf({id, name, created, snapshots_done, kept_until}, now) {
  const days = Math.max(Math.ceil((Date.parse(kept_until) - now.getTime()) / 86400e3), 0);
  return {
    id,
    name: name || text('scan.unnamed', {when: format.when(created)}),
    about: text('bin.about', {snapshots: text('count.snapshots', {count: snapshots_done}), count: days}),
  };
}

/** @param {requests.Binned[]} scans */
function render(scans) {
  show(element('bin'), scans.length > 0);
  setText(element('bin-title'), text('bin.title', {count: scans.length}));
  list(element('bin-rows'), scans.map((scan) => rowOf(scan, new Date())), ({id}) => id, 'bin-row', (item, row) => {
    setVerbatim(part(item, '.scan-name'), row.name);
    setText(part(item, '.scan-about'), row.about);
    part(item, 'button').setAttribute('aria-label', text('library.action', {action: text('bin.restore'), name: row.name}));
  });
}

/** Reads the bin if scans were added or deleted. @param {number} current  revision of the scans */
export async function seeRevision(current) {
  if (current === revision || !element('bin')) {  // the library's fragment is not loaded yet
    return;
  }
  const before = revision;
  revision = current;
  try {
    render(await requests.bin());
  } catch {
    revision = before;  // retried at the next poll
  }
}

/** Makes the next poll read the bin again. */
export function refresh() {
  revision = 0;
}

export function hideUndo() {
  clearTimeout(timer);
  show(element('deleted'), false);
}

/** Offers for a while to restore a scan that has just been deleted. @param {string} name @param {() => void} undo */
export function offerUndo(name, undo) {
  clearTimeout(timer);
  setText(element('deleted-text'), text('bin.moved', {name}));
  show(element('deleted'), true);
  part(element('deleted'), 'button').onclick = () => {
    hideUndo();
    undo();
  };
  timer = setTimeout(hideUndo, undoLasts);
}

/** @param {{restore: (id: string) => void, empty: () => void}} actions */
export function prepareBin(actions) {
  element('bin-rows').addEventListener('click', (/** @type {any} */ event) => {
    if (event.target.closest('button')) {
      actions.restore(event.target.closest('li').dataset.key);
    }
  });
  element('bin-empty').addEventListener('click', actions.empty);
}
