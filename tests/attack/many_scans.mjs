// many_scans SCANS: a data folder of SCANS scans, every second one unfinished. The processor times per scan of the start and of the
// list, and that of the status, must be about those with a tenth of the scans, and memory per scan is bounded.

import {renameSync, rmSync} from 'node:fs';
import {join} from 'node:path';

import {argument, Daemon, makeFolder, require, requireMemory} from './daemon.mjs';
import {copyScan, idOf} from './scans.mjs';

const count = argument(0, 2000);
const folder = makeFolder();
const slack = 4; // allowed factor, as caches are shared with other programs
const moment = 100; // ms, allowance for what the kernel counts in ticks of 10 ms

/** Measures the daemon on the folder as it is. */
async function measure() {
  const daemon = await Daemon.start(folder);
  const start = daemon.processorTime('main');
  /** The processor time of an answer, ms. */
  const time = async (path, times) => {
    const before = daemon.processorTime('server');
    for (let i = 0; i < times; ++i) {
      await daemon.get(path);
    }
    return (daemon.processorTime('server') - before) / times;
  };
  const listed = (await daemon.get('/api/v1/scans')).scans.length;
  const list = await time('/api/v1/scans', 20);
  const status = await time('/api/v1/status', 100);
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
  `${listed} scans: start ${start} ms, list ${list.toFixed(1)} ms, status ${status.toFixed(1)} ms, ${Math.round(memory / 1e6)} MB`;
console.log(`counted: many_scans: of processor time, with ${shown(few)}; with ${shown(many)}`);
require(few.listed === count / 10 && many.listed === count, 'not all are listed');
for (const what of ['start', 'list']) {
  require(many[what] < moment + 10 * slack * few[what], `${what} takes longer for each scan where there are more`);
}
require(many.status < 1 + 2 * slack * few.status, 'status takes longer where there are more scans');
// Scans are held in memory, and so is the text of their list, possibly several times at once. By the sensor's noise, the verdict of
// every second scan here has 100 places or 300.
requireMemory(many.memory - few.memory < 120_000 * count, 'a scan takes more than 120 kB of memory');
