// many_scans SCANS: a data folder of SCANS scans, every second one unfinished. The times per scan of the start and of the list, and
// the time of the status, must be about those with a tenth of the scans, and memory per scan is bounded.

import {renameSync, rmSync} from 'node:fs';
import {join} from 'node:path';

import {argument, Daemon, makeFolder, require, requireMemory} from './daemon.mjs';
import {copyScan, idOf} from './scans.mjs';

const count = argument(0, 2000);
const folder = makeFolder();
const slack = 4; // allowed factor for the load of a busy machine
const moment = 2000; // ms, allowance for a busy machine

/** The shortest duration of several runs of an action, ms. */
async function time(action, times = 3) {
  let shortest = Infinity;
  for (let i = 0; i < times; ++i) {
    const begin = performance.now();
    await action();
    shortest = Math.min(shortest, performance.now() - begin);
  }
  return shortest;
}

/** Measures the daemon on the folder as it is. */
async function measure() {
  let daemon;
  const start = await time(async () => {
    await daemon?.end();
    daemon = await Daemon.start(folder);
  }, 2);
  const listed = (await daemon.get('/api/v1/scans')).scans.length;
  const list = await time(() => daemon.get('/api/v1/scans'));
  const status = await time(() => daemon.get('/api/v1/status'), 5);
  const memory = daemon.memory();
  await daemon.end();
  return {listed, start, list, status, memory};
}

const daemon = await Daemon.start(folder);
const finished = await daemon.whenDone((await daemon.scan({snapshots: 2, frames: 1, leaf_size_mm: 4})).id);
const {id} = await daemon.scan({snapshots: 200, frames: 1, leaf_size_mm: 4});
await daemon.end('SIGKILL');
const scans = join(folder, 'data', 'scans');
const templates = [join(folder, 'finished'), join(folder, 'unfinished')];
renameSync(join(scans, finished.id), templates[0]);
renameSync(join(scans, id), templates[1]);
rmSync(scans, {recursive: true});

const results = [];
let made = 0;
for (const target of [count / 10, count]) {
  for (; made < target; ++made) {
    copyScan(templates[made % 2], join(scans, idOf(made)));
  }
  results.push(await measure());
}
const [few, many] = results;
const shown = ({listed, start, list, status, memory}) =>
  `${listed} scans: start ${start.toFixed(0)} ms, list ${list.toFixed(0)} ms, status ${status.toFixed(1)} ms, ${Math.round(memory / 1e6)} MB`;
console.log(`counted: many_scans: ${shown(few)}; ${shown(many)}`);
require(few.listed === count / 10 && many.listed === count, 'not all are listed');
for (const what of ['start', 'list']) {
  require(many[what] < moment + 10 * slack * few[what], `${what} takes longer for each scan where there are more`);
}
require(many.status < 50 + 2 * slack * few.status, 'status takes longer where there are more scans');
// Scans are held in memory, and so is the text of their list, possibly several times at once.
requireMemory(many.memory - few.memory < 50_000 * count, 'a scan takes more than 50 kB of memory');
