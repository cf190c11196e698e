// random_kills KILLS [SEED]: kills the daemon (SIGKILL) at random moments of scans, every third time while a model is built, and
// restarts it. Every accepted scan must still be there with every snapshot that was reported, and no file may be partial. At the end
// all scans are resumed and must finish.

import {argument, Daemon, makeFolder, require, requireWholeFiles, sleep, until} from './daemon.mjs';
import {makeRandom} from './random.mjs';

const kills = argument(0, 8);
const seed = argument(1, 20261123);
const random = makeRandom(seed);
const folder = makeFolder();
const kept = 20; // finished scans; older ones are deleted

let daemon = await Daemon.start(folder);
const told = new Map(); // the number of snapshots that the daemon reported, by accepted scan
const phases = {};
let resumed = 0;

async function look(id) {
  const scan = await daemon.get(`/api/v1/scans/${id}`);
  told.set(id, Math.max(told.get(id) ?? 0, scan.snapshots_done));
  return scan;
}

/** Resumes an interrupted scan, or starts a new one. */
async function begin() {
  const {scans} = await daemon.get('/api/v1/scans');
  const interrupted = scans.find((scan) => scan.state === 'interrupted' || scan.state === 'paused');
  if (interrupted && random.chance(0.5)) {
    const reply = await daemon.ask('POST', `/api/v1/scans/${interrupted.id}/resume`);
    require(reply.status === 202, `a scan that is ${interrupted.state} cannot be resumed: ${reply.body}`);
    ++resumed;
    return interrupted.id;
  }
  const {id} = await daemon.scan({snapshots: 2 + random.below(4), frames: 1 + random.below(2), leaf_size_mm: random.pick([1, 2]),
    method: random.pick(['solid', 'solid', 'intersection'])});
  told.set(id, 0);
  return id;
}

/** Waits until the moment at which the daemon is killed. */
async function waitForTheMoment(id, inBuilding) {
  if (inBuilding) {
    await until(async () => {
      const scan = await look(id);
      return scan.phase === 'building' || scan.state !== 'running';
    }, 'a model is built');
    await sleep(random.below(120));
  } else {
    await sleep(random.below(1200));
  }
  const scan = await look(id);
  const phase = scan.state === 'running' ? scan.phase : scan.state;
  phases[phase] = (phases[phase] ?? 0) + 1;
}

async function checkAll() {
  const {scans} = await daemon.get('/api/v1/scans');
  for (const [id, snapshots] of told) {
    const scan = scans.find((other) => other.id === id);
    require(scan, `the scan ${id} is lost`);
    require(['interrupted', 'paused', 'finished'].includes(scan.state), `the scan ${id} is ${JSON.stringify(scan)}`);
    require(scan.snapshots_done >= snapshots, `the scan ${id} had ${snapshots} snapshots, and has ${scan.snapshots_done}`);
  }
  requireWholeFiles(daemon.data);
  const finished = scans.filter((scan) => scan.state === 'finished');
  for (const scan of finished.slice(kept)) {
    await daemon.ask('DELETE', `/api/v1/scans/${scan.id}`);
    told.delete(scan.id);
  }
}

try {
  for (let i = 0; i < kills; ++i) {
    await waitForTheMoment(await begin(), i % 3 === 0);
    const [, signal] = await daemon.end('SIGKILL');
    require(signal === 'SIGKILL', `the daemon had ended before: ${daemon.log}`);
    daemon = await Daemon.start(folder);
    await checkAll();
  }
  for (const {id, state} of (await daemon.get('/api/v1/scans')).scans) {
    if (state !== 'finished') {
      const reply = await daemon.ask('POST', `/api/v1/scans/${id}/resume`);
      require(reply.status === 202, `the scan ${id} cannot be resumed: ${reply.body}`);
      const scan = await daemon.whenDone(id);
      require(scan.state === 'finished', `the scan ${id} ends as ${JSON.stringify(scan)}`);
      ++resumed;
    }
  }
  requireWholeFiles(daemon.data);
  await daemon.end();
  console.log(`counted: random_kills: ${kills} kills (seed ${seed}) in ${JSON.stringify(phases)}, ${resumed} resumed, no scan lost`);
} catch (error) {
  console.error(`random_kills: seed ${seed}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
