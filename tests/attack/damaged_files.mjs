// damaged_files ARCHIVES STARTS [SEED]: imports ARCHIVES damaged archives, up to the model, and starts the daemon STARTS times with damaged
// files of its own, or with a folder or a FIFO in the place of one. It must refuse or finish each import, find the same scans after a restart,
// serve whatever its files are, and end when asked to.

import {execFileSync} from 'node:child_process';
import {mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

import {importOf, smallScan, zipOf} from './archives.mjs';
import {damagedBytes, damagedJson} from './damage.mjs';
import {argument, Daemon, makeFolder, require, requireMemory, requireWholeFiles, sleep} from './daemon.mjs';
import {makeRandom} from './random.mjs';

const archives = argument(0, 60);
const starts = argument(1, 6);
const seed = argument(2, 20261128);
const random = makeRandom(seed);
const folder = makeFolder();
const batch = 20; // archives between restarts
const mb = 2 ** 20;
const counts = {};
let daemon = await Daemon.start(folder, {settings: {memory_limit_mb: 64}});
let moment = '';

/** An archive with one damage: of its bytes, or, with right checksums, of a file in it. */
function damagedArchive(files) {
  if (random.chance(0.2)) {
    return damagedBytes(random, zipOf(files));
  }
  const index = random.chance(0.7) ? 0 : random.below(files.length);
  return zipOf(files.map(([name, content], i) => {
    if (i !== index) {
      return [name, content];
    }
    return [name, name.endsWith('.json') ? damagedJson(random, content.toString()) : damagedBytes(random, content)];
  }));
}

function requireFinite(model) {
  require(model.length === 84 + 50 * model.readUInt32LE(80), 'a model is not whole');
  for (let at = 84; at < model.length; at += 50) {
    for (let i = 0; i < 12; ++i) {
      require(Number.isFinite(model.readFloatLE(at + 4 * i)), 'a model has a number that is none');
    }
  }
}

/** Imports an archive, and gives its model some time. */
async function takeOne(files) {
  const archive = damagedArchive(files);
  writeFileSync(join(folder, 'last.zip'), archive);
  const {status, text} = await importOf(daemon, archive);
  counts[status] = (counts[status] ?? 0) + 1;
  require([201, 400].includes(status), `${status}: ${text}`);
  require(status === 201 || JSON.parse(text).title, `it is refused without a reason: ${text}`);
  if (status !== 201) {
    return;
  }
  const {id} = JSON.parse(text);
  let scan = await daemon.get(`/api/v1/scans/${id}`);
  for (let i = 0; i < 100 && scan.state === 'running'; ++i) {
    await sleep(20);
    scan = await daemon.get(`/api/v1/scans/${id}`);
  }
  await daemon.ask('POST', `/api/v1/scans/${id}/cancel`);
  scan = await daemon.whenDone(id);
  counts[scan.state] = (counts[scan.state] ?? 0) + 1;
  require(scan.state !== 'failed' || (scan.error.code !== 'internal' && scan.error.detail), `it fails: ${JSON.stringify(scan.error)}`);
  if (scan.state === 'finished') {
    requireFinite((await daemon.ask('GET', `/api/v1/scans/${id}/Scan.stl`)).body);
  }
}

async function restart() {
  const [status] = await daemon.end();
  require(status === 0, `it ends with ${status}`);
  daemon = await Daemon.start(folder, {settings: {memory_limit_mb: 64}});
}

const seen = async () => (await daemon.get('/api/v1/scans')).scans.map(({id, state, snapshots_done: done}) => `${id} ${state} ${done}`).sort();

/** The scans before a restart are those after it. Removes them. */
async function checkScans() {
  const before = await seen();
  await restart();
  const after = await seen();
  require(before.join() === after.join(), `before the restart ${before}, and after it ${after}`);
  requireWholeFiles(daemon.data);
  for (const line of after) {
    await daemon.ask('DELETE', `/api/v1/scans/${line.split(' ')[0]}`);
  }
  await daemon.ask('DELETE', '/api/v1/bin');
}

/** Starts the daemon with damaged files of its own, and changes its settings. */
async function startDamaged(whole) {
  const [status] = await daemon.end();
  require(status === 0, `it ends with ${status}`);
  rmSync(join(folder, 'data'), {recursive: true});
  mkdirSync(join(folder, 'data'));
  const blocked = random.chance(0.4) ? random.pick(Object.keys(whole)) : '';
  for (const [name, bytes] of Object.entries(whole)) {
    if (name === blocked) {
      execFileSync(random.pick(['mkdir', 'mkfifo']), [join(folder, 'data', name)]);
      continue;
    }
    const damaged = random.chance(0.5) ? damagedJson(random, bytes.toString()) : bytes;
    writeFileSync(join(folder, 'data', name), damaged, {mode: 0o600});
  }
  daemon = await Daemon.start(folder, {settings: {memory_limit_mb: 64}});
  await daemon.get('/api/v1/status');
  await daemon.get('/api/v1/scans');
  await daemon.get('/api/v1/settings');
  require((await daemon.ask('GET', '/api/v1/diagnostics.zip')).status === 200, 'there are no diagnostics');
  const changed = await daemon.ask('PATCH', '/api/v1/settings', {scan: {frames: 3}});
  const isTold = blocked && changed.status === 500 && changed.json.code !== 'internal';
  require([200, 409].includes(changed.status) || isTold, `PATCH settings: ${changed.status} ${changed.body}`);
}

try {
  const files = smallScan();
  moment = 'a whole archive';
  const whole = await importOf(daemon, zipOf(files));
  require(whole.status === 201, `${whole.status}: ${whole.text}`);
  const scan = await daemon.whenDone(JSON.parse(whole.text).id);
  require(scan.state === 'finished', `its scan is ${JSON.stringify(scan)}`);
  const idle = daemon.memory();
  for (let i = 0; i < archives; ++i) {
    moment = `archive ${i}`;
    await takeOne(files);
    require(daemon.isAlive, 'the daemon has ended');
    requireMemory(daemon.memory() < idle + 100 * mb, `it has ${daemon.memory() / mb} MB, and had ${idle / mb}`);
    if (i % batch === batch - 1) {
      await checkScans();
    }
  }
  await checkScans();
  moment = 'settings';
  await daemon.ask('PATCH', '/api/v1/settings', {scan: {frames: 7, leaf_size_mm: 1.5}});
  await daemon.ask('POST', '/api/v1/keys', {name: 'a program', access: 'read'});
  await daemon.ask('POST', '/api/v1/webhooks', {url: 'http://127.0.0.1:9/hook', events: ['scan-finished']});
  const own = Object.fromEntries(readdirSync(daemon.data).filter((name) => name.endsWith('.json'))
      .map((name) => [name, readFileSync(join(daemon.data, name))]));
  require(own['settings.json'] && own['keys.json'] && own['addresses.json'], `the daemon's files are ${Object.keys(own)}`);
  for (let i = 0; i < starts; ++i) {
    moment = `start ${i}`;
    await startDamaged(own);
  }
  await daemon.end();
  console.log(`counted: damaged_files: ${archives} archives ${JSON.stringify(counts)}, ${starts} starts with damaged ${Object.keys(own)} (seed ${seed})`);
} catch (error) {
  console.error(`damaged_files: seed ${seed}: ${moment}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
