// Actions on scans: start, end, name, delete and restore.

import * as api from '../api/api.js';
import * as bin from './bin.js';
import * as binRequests from '../api/api_bin.js';
import {chosenSettings} from './form.js';
import {act, state} from '../page.js';
import {nameOf} from '../screen.js';
import * as states from '../state.js';
import {text} from '../base/texts.js';
import {askEmptyBin, askName} from '../view.js';

export const start = () => act('failure.start', async () => {
  const scan = await api.start(chosenSettings());
  return (now) => states.withStarted(now, scan);
});

/** Asks the running scan to stop. @param {string} failure  key of the failure's text @param {(id: string) => Promise<unknown>} request */
const stop = (failure, request) => act(failure, async () => {
  const id = states.running(state)?.id ?? null;
  if (id) {
    await request(id);
  }
  return (now) => states.withStopping(now, id);
});

export const pause = () => stop('failure.pause', api.pause);

export const cancel = () => stop('failure.end', api.cancel);

/** @param {File} file */
export const importScan = (file) => act('failure.import', async () => {
  const scan = await api.importScan(file);
  location.hash = scan.state === 'running' ? '' : scan.id;
  return (now) => scan.state === 'running' ? states.withStarted(now, scan) : states.withSelected(states.withScan(now, scan), scan.id);
});

export const resume = () => act('failure.resume', async () => {
  const scan = await api.resume(/** @type {string} */ (state.selected));
  return (now) => states.withStarted(now, scan);
});

export const end = () => act('failure.end', async () => {
  const scan = await api.cancel(/** @type {string} */ (state.selected));
  return (now) => states.withScan(now, scan);
});

/** @param {string | null} id */
export async function rename(id) {
  const scan = states.scanOf(state, id);
  const name = scan && await askName(nameOf(scan));
  if (scan && name !== null) {
    await act('failure.rename', async () => {
      const renamed = await api.label(scan.id, {name});
      return (now) => states.withScan(now, renamed);
    });
  }
}

/** @param {string | null} id */
export async function remove(id) {
  const scan = states.scanOf(state, id);
  if (scan) {
    await act('failure.delete', async () => {
      await api.remove(scan.id);
      bin.offerUndo(nameOf(scan), () => restore([scan.id]));
      return (now) => states.withoutScan(now, scan.id);
    }, scan.id);
  }
}

/** Moves all selected scans to the bin. */
export async function removeChosen() {
  const ids = state.library.chosen ?? [];
  if (ids.length === 0) {
    return;
  }
  await act('failure.delete-all', async () => {
    /** @type {string[]} */
    const removed = [];
    try {
      for (const id of ids) {
        await api.remove(id);
        removed.push(id);
      }
    } finally {
      removed.length > 0 && bin.offerUndo(text('count.scans', {count: removed.length}), () => restore(removed));
    }
    return (now) => states.withLibrary(ids.reduce(states.withoutScan, now), {chosen: null});
  });
}

/** Adds a tag to all selected scans. @param {string} tag */
export const tagChosen = (tag) => act('failure.tag', async () => {
  const chosen = state.scans.filter(({id, tags}) => state.library.chosen?.includes(id) && !tags.includes(tag));
  /** @type {states.Scan[]} */
  const tagged = [];
  for (const {id, tags} of chosen) {
    tagged.push(await api.label(id, {tags: [...tags, tag]}));
  }
  return (now) => tagged.reduce(states.withScan, now);
}, tag);

/** @param {string[]} ids */
export const restore = (ids) => act(ids.length > 1 ? 'failure.restore-all' : 'failure.restore', async () => {
  for (const id of ids) {
    await binRequests.restore(id);
  }
  const scans = await api.scans();
  return (now) => states.withScans(now, scans);
}, ids.join());

export async function emptyBin() {
  if (await askEmptyBin()) {
    await act('failure.empty-bin', async () => {
      await binRequests.emptyBin();
      bin.hideUndo();
      bin.refresh();
      return (now) => now;
    });
  }
}
