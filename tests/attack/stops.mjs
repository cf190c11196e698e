// stops MOMENTS [SEED]: at MOMENTS random moments of each phase of a scan, of fine models and of imports, the scan is cancelled or the daemon
// is asked to end (SIGTERM), in turns. It must do so within three seconds, not counting how long its threads waited for a processor of this
// machine. No accepted scan is lost, and no file is partial.

import {existsSync, readdirSync, readFileSync} from 'node:fs';
import {join} from 'node:path';

import {argument, Daemon, makeFolder, require, requireWholeFiles, sleep, until} from './daemon.mjs';
import {importOf, manySnapshots} from './archives.mjs';
import {makeRandom} from './random.mjs';

const moments = argument(0, 2);
const seed = argument(1, 20261128);
const random = makeRandom(seed);
const folder = makeFolder();
const allowed = process.env.OCTURN_SANITIZED ? 30_000 : 3000; // ms
const fine = {snapshots: 6, frames: 1, leaf_size_mm: process.env.OCTURN_SANITIZED ? 0.4 : 0.1, calibrate: 'told', clip_mm: [-60, -60, 5, 60, 60, 130]};
const fineAndSmall = {...fine, snapshots: 2, clip_mm: [-15, -15, 5, 15, 15, 60]}; // whose snapshots are integrated soon
const longest = {};
let daemon = await Daemon.start(folder);
let moment = '';

/** How long each of the daemon's threads waited for a processor so far, ms. @returns {Map<string, number>} */
function waits() {
  const tasks = `/proc/${daemon.program.pid}/task`;
  const all = new Map();
  for (const task of existsSync(tasks) ? readdirSync(tasks) : []) {
    try {
      all.set(task, Number(readFileSync(`${tasks}/${task}/schedstat`, 'utf8').split(' ')[1]) / 1e6);
    } catch {
      // the thread has ended
    }
  }
  return all;
}

/** Does something, and requires that it takes no longer than is allowed, but for what one thread waited for a processor. */
async function require3s(what, action) {
  const before = waits();
  let waited = 0;
  const watch = setInterval(() => {
    for (const [task, ms] of waits()) {
      waited = Math.max(waited, ms - (before.get(task) ?? 0));
    }
  }, 20);
  const begin = performance.now();
  await action();
  const took = performance.now() - begin;
  clearInterval(watch);
  longest[what] = Math.max(longest[what] ?? 0, Math.round(took));
  require(took - waited < allowed, `${moment}: ${what} took ${took.toFixed(0)} ms, ${waited.toFixed(0)} of them waiting`);
}

/** Waits until a scan is in a phase. @returns {Promise<boolean>} whether it was seen there */
async function reaches(id, phase) {
  const scan = await until(async () => {
    const now = await daemon.get(`/api/v1/scans/${id}`);
    return now.phase === phase || now.state !== 'running' ? now : null;
  }, `a scan is ${phase}`);
  return scan.phase === phase && scan.state === 'running';
}

async function restart() {
  let status = null;
  await require3s('SIGTERM', async () => {
    [status] = await daemon.end();
  });
  require(status === 0, `${moment}: SIGTERM ends the daemon with ${status}: ${daemon.log}`);
  daemon = await Daemon.start(folder);
}

/** Deletes all scans, after a look at them. */
async function tidy() {
  requireWholeFiles(daemon.data);
  for (const {id, state} of (await daemon.get('/api/v1/scans')).scans) {
    require(state !== 'failed', `${moment}: the scan ${id} has failed`);
    require((await daemon.ask('DELETE', `/api/v1/scans/${id}`)).status === 204, `${moment}: ${id} cannot be deleted`);
  }
  await daemon.ask('DELETE', '/api/v1/bin');
}

/** Stops a scan in one of its phases. @returns {Promise<boolean>} whether it was in it */
async function stopScan(phase, settings, delay, cancels) {
  const {id} = await daemon.scan(settings);
  const wasThere = await reaches(id, phase);
  await sleep(random.below(delay));
  const isThere = wasThere && (await daemon.get(`/api/v1/scans/${id}`)).state === 'running';
  if (cancels) {
    await require3s('cancel', async () => {
      await daemon.ask('POST', `/api/v1/scans/${id}/cancel`);
      await daemon.whenDone(id);
    });
  } else {
    await restart();
  }
  const {state} = await daemon.get(`/api/v1/scans/${id}`);
  require(['cancelled', 'interrupted', 'finished'].includes(state), `${moment}: the scan is ${state}`);
  await tidy();
  return isThere;
}

/** Stops the daemon while it receives or checks an archive. The scan is there whole, or not at all. */
async function stopImport(archive) {
  const reply = importOf(daemon, archive).catch(() => null);
  await sleep(random.below(1500));
  await restart();
  const answer = await reply;
  const {scans} = await daemon.get('/api/v1/scans');
  require(answer?.status !== 201 || scans.length === 1, `${moment}: an import that was accepted is not there`);
  await tidy();
}

// Phase, settings, longest delay in it (ms).
const phases = {
  turning: ['turning', {snapshots: 40, frames: 1, leaf_size_mm: 2}, 100],
  capturing: ['capturing', {snapshots: 40, frames: 2, leaf_size_mm: 2}, 300],
  calibrating: ['calibrating', {snapshots: 12, frames: 1, leaf_size_mm: 2, calibrate: 'auto'}, 300],
  building: ['building', {snapshots: 6, frames: 1, leaf_size_mm: 1}, 300],
  'integrating fine leaves': ['capturing', {...fine, method: 'solid'}, 5000],
  'building a fine solid': ['building', {...fineAndSmall, method: 'solid'}, 2000],
  'building a fine intersection': ['building', {...fine, method: 'intersection'}, 5000],
};

try {
  const counts = {};
  const archive = manySnapshots(600, 640, 480);
  for (let i = 0; i < moments; ++i) {
    for (const [index, [name, phase]] of Object.entries(phases).entries()) {
      moment = `${i}, ${name}`;
      for (let tries = 0, isThere = false; !isThere && tries < 5; ++tries) { // a short phase may pass between two looks
        isThere = await stopScan(...phase, (i + index) % 2 === 1);
        counts[name] = (counts[name] ?? 0) + Number(isThere);
      }
    }
    moment = `${i}, an import`;
    await stopImport(archive);
    counts.import = (counts.import ?? 0) + 1;
  }
  for (const [name, count] of Object.entries(counts)) {
    require(count > 0, `no moment was in: ${name}`);
  }
  await daemon.end();
  console.log(`counted: stops: ${JSON.stringify(counts)} moments (seed ${seed}); longest, with waits for a processor, ms: ${JSON.stringify(longest)}`);
} catch (error) {
  console.error(`stops: seed ${seed}: ${moment}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
