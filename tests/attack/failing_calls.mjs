// failing_calls RUNS [SEED]: in RUNS runs, one kind of system call on the data folder fails with one error for a while, at a random moment of
// a scan, an export or a change of the settings. The daemon must survive and tell the error; healed, killed and started again it has every
// finished scan, and no partial file.

import {readFileSync} from 'node:fs';
import {join} from 'node:path';

import {argument, Daemon, makeFolder, require, requireWholeFiles} from './daemon.mjs';
import {calls, Faults} from './faults.mjs';
import {makeRandom} from './random.mjs';

const runs = argument(0, 6);
const seed = argument(1, 20261128);
const random = makeRandom(seed);
const folder = makeFolder();
const errors = ['ENOSPC', 'EIO', 'EMFILE', 'ENOMEM', 'EAGAIN'];
const pairs = Object.keys(calls).flatMap((call) => errors.map((error) => [call, error]));
const settings = {snapshots: 2, frames: 1, leaf_size_mm: 4};
const states = {};
const faults = new Faults(folder, join(folder, 'data'));
let daemon;
let moment = '';
let failed = 0;

/** Has the daemon do what it can while a call fails. */
async function useIt(id) {
  const started = await daemon.ask('POST', '/api/v1/scans', settings);
  require([202, 500, 503].includes(started.status), `POST scans: ${started.status} ${started.body}`);
  for (const [method, path, body] of [['GET', `scans/${id}/scan.zip`], ['PATCH', 'settings', {scan: {frames: 1 + random.below(9)}}],
    ['PATCH', `scans/${id}`, {name: `a name ${random.below(99)}`}], ['POST', 'keys', {name: 'a program', access: 'read'}],
    ['GET', `scans/${id}/Scan.stl`], ['GET', 'scans'], ['GET', 'diagnostics.zip']]) {
    const reply = await daemon.ask(method, `/api/v1/${path}`, body).catch((error) => ({status: error.code}));
    require([200, 201, 404, 409, 500, 503, 'ECONNRESET'].includes(reply.status), `${method} ${path}: ${reply.status} ${reply.body}`);
    require(reply.status !== 500 || reply.json?.code !== 'internal', `${method} ${path}: ${reply.body}`);
  }
  failed += faults.counts().failed;
  faults.lift(); // a scan that cannot write tries again for half a minute
  const scan = started.status === 202 ? await daemon.whenDone(started.json.id) : {state: 'refused', error: started.json};
  states[scan.state] = (states[scan.state] ?? 0) + 1;
  require(scan.state === 'finished' || scan.error, `the scan is ${scan.state} without a reason`);
}

try {
  daemon = await Daemon.start(folder, {env: faults.env});
  const {id} = await daemon.whenDone((await daemon.scan(settings)).id);
  const model = readFileSync(join(daemon.data, 'scans', id, 'Scan.stl'));
  for (let i = 0; i < runs; ++i) {
    const [call, error] = runs < pairs.length ? random.pick(pairs) : pairs[i % pairs.length];
    moment = `${i}: ${call} fails with ${error}`;
    faults.fail(calls[call], error, {first: 1 + random.below(30), count: random.pick([1, 3, 1e9])});
    await useIt(id);
    require(daemon.isAlive, 'the daemon has ended');
    const next = await daemon.whenDone((await daemon.scan(settings)).id);
    require(next.state === 'finished', `the next scan is ${JSON.stringify(next)}`);
    await daemon.end('SIGKILL');
    daemon = await Daemon.start(folder, {env: faults.env});
    const {scans} = await daemon.get('/api/v1/scans');
    require(scans.find((scan) => scan.id === next.id)?.state === 'finished', `${next.id} is lost`);
    const reply = await daemon.ask('GET', `/api/v1/scans/${id}/Scan.stl`);
    require(reply.status === 200 && reply.body.equals(model), `the first model is not what it was: ${reply.status}`);
    requireWholeFiles(daemon.data);
    for (const scan of scans.filter((other) => other.id !== id)) {
      require((await daemon.ask('DELETE', `/api/v1/scans/${scan.id}`)).status === 204, `${scan.id} cannot be deleted`);
    }
    await daemon.ask('DELETE', '/api/v1/bin');
    for (const key of (await daemon.get('/api/v1/keys')).keys) { // of which there may be 32
      await daemon.ask('DELETE', `/api/v1/keys/${key.id}`);
    }
  }
  await daemon.end();
  require(failed > 0, 'no call failed: the library is not in force');
  console.log(`counted: failing_calls: ${failed} calls failed in ${runs} runs of ${Object.keys(calls).length} calls and ${errors.length} errors ` +
    `(seed ${seed}), scans ${JSON.stringify(states)}, none lost`);
} catch (error) {
  console.error(`failing_calls: seed ${seed}: ${moment}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
