// failing_disk FULL PLACES [SEED]: in FULL scans the disk is full from a random write on, and PLACES files get an unreadable
// sector. The daemon must survive, serve what it can, keep every other scan, and work again when the fault is gone.

import {readFileSync} from 'node:fs';
import {join, relative} from 'node:path';

import {argument, Daemon, filesBelow, makeFolder, require, requireWholeFiles} from './daemon.mjs';
import {changing, Faults, reading, writing} from './faults.mjs';
import {makeRandom} from './random.mjs';

const full = argument(0, 4);
const places = argument(1, 6);
const seed = argument(2, 20261123);
const random = makeRandom(seed);
const folder = makeFolder();
const settings = {snapshots: 3, frames: 1, leaf_size_mm: 2};
let daemon;
let moment = '';

const modelOf = (id) => daemon.ask('GET', `/api/v1/scans/${id}/Scan.stl`);

/** Checks that the daemon answers, and that a scan still has its model. */
async function checkService(id, model) {
  require(daemon.isAlive, 'the daemon has ended');
  await daemon.get('/api/v1/status');
  const {scans} = await daemon.get('/api/v1/scans');
  require(scans.some((scan) => scan.id === id), `the scan ${id} is lost`);
  const reply = await modelOf(id);
  require(reply.status === 200 && reply.body.equals(model), `the model of ${id} is not what it was: ${reply.status}`);
}

/** Runs a scan on a disk that is full from one write on. After the scan's end the disk has room again. */
async function fillDisk(faults, writes, id, model) {
  const first = 1 + random.below(writes);
  const error = random.pick(['ENOSPC', 'ENOSPC', 'EIO', 'EDQUOT']);
  moment = `${error} from write ${first} of ${writes}`;
  faults.fail(writing, error, {first});
  const reply = await daemon.ask('POST', '/api/v1/scans', settings);
  require([202, 500, 503].includes(reply.status), `POST scans: ${reply.status} ${reply.body}`);
  const scan = reply.status === 202 ? await daemon.whenDone(reply.json.id) : null;
  require(faults.counts().failed > 0 || scan?.state === 'finished', `no write failed, and the scan is ${scan?.state}`);
  await checkService(id, model);
  faults.lift();
  if (scan && scan.state !== 'finished') {
    require(scan.error, `the scan is ${scan.state} without a reason`);
    const now = await daemon.get(`/api/v1/scans/${scan.id}`);
    if (['interrupted', 'paused'].includes(now.state)) {
      const resumed = await daemon.ask('POST', `/api/v1/scans/${scan.id}/resume`);
      require(resumed.status === 202, `it cannot be resumed: ${resumed.body}`);
      require((await daemon.whenDone(scan.id)).state === 'finished', 'resumed, it does not finish');
    }
  }
  const after = await daemon.whenDone((await daemon.scan(settings)).id);
  require(after.state === 'finished', `the next scan is ${JSON.stringify(after)}`);
  requireWholeFiles(daemon.data);
  for (const other of (await daemon.get('/api/v1/scans')).scans.filter((other) => other.id !== id)) {
    require((await daemon.ask('DELETE', `/api/v1/scans/${other.id}`)).status === 204, `${other.id} cannot be deleted`);
  }
}

/** Starts the daemon on a disk that became full or read-only during a scan. */
async function startOnABadDisk(faults, kinds, error, id, model) {
  moment = `start with ${error}`;
  const cut = await daemon.scan({...settings, snapshots: 100});
  await daemon.end('SIGKILL');
  faults.fail(kinds, error);
  daemon = await Daemon.start(folder, {env: faults.env});
  await checkService(id, model);
  require((await daemon.get(`/api/v1/scans/${cut.id}`)).state === 'interrupted', 'a scan that was cut off is not told so');
  const refused = await daemon.ask('POST', '/api/v1/scans', settings);
  if (refused.status === 202) {
    const scan = await daemon.whenDone(refused.json.id);
    require(scan.state === 'failed' && scan.error.hint, `a scan on such a disk is ${JSON.stringify(scan)}`);
  }
  faults.lift();
  require((await daemon.ask('DELETE', `/api/v1/scans/${cut.id}`)).status === 204, 'it cannot be deleted on a disk with room');
}

/** Starts the daemon with a file that cannot be read, or cannot be opened. */
async function spoil(file, id, model) {
  const faults = new Faults(folder, file);
  moment = `${relative(folder, file)} is unreadable`;
  faults.fail(reading, 'EIO');
  daemon = await Daemon.start(folder, {env: faults.env});
  await daemon.get('/api/v1/status');
  await daemon.get('/api/v1/scans');
  require((await daemon.ask('GET', '/api/v1/diagnostics.zip')).status === 200, 'there are no diagnostics');
  if (!file.includes(id)) {
    await checkService(id, model);
  }
  const next = await daemon.whenDone((await daemon.scan(settings)).id);
  require(next.state === 'finished', `the next scan is ${JSON.stringify(next)}`);
  await daemon.ask('DELETE', `/api/v1/scans/${next.id}`);
  const [status] = await daemon.end();
  require(status === 0, `it ends with ${status}`);
  faults.close();
}

try {
  const faults = new Faults(folder, join(folder, 'data'));
  daemon = await Daemon.start(folder, {env: faults.env});
  const first = await daemon.whenDone((await daemon.scan(settings)).id);
  require(first.state === 'finished', `the first scan is ${JSON.stringify(first)}`);
  const model = readFileSync(join(daemon.data, 'scans', first.id, 'Scan.stl'));
  faults.fail(writing, 'ENOSPC', {count: 0});
  const second = await daemon.whenDone((await daemon.scan(settings)).id);
  const writes = faults.counts().seen;
  require(writes > 20, `a scan writes ${writes} times: the library is not in force`);
  await daemon.ask('DELETE', `/api/v1/scans/${second.id}`);
  for (let i = 0; i < full; ++i) {
    await fillDisk(faults, writes, first.id, model);
  }
  await startOnABadDisk(faults, writing, 'ENOSPC', first.id, model);
  await startOnABadDisk(faults, changing, 'EROFS', first.id, model);
  await daemon.end();
  faults.close();
  const files = filesBelow(daemon.data);
  for (let i = 0; i < places; ++i) {
    await spoil(places < files.length ? random.pick(files) : files[i % files.length], first.id, model);
  }
  console.log(`counted: failing_disk: full at ${full} of ${writes} writes, full and read-only at starts, ${places} unreadable files of ${files.length} ` +
    `(seed ${seed}), no other scan lost`);
} catch (error) {
  console.error(`failing_disk: seed ${seed}: ${moment}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
