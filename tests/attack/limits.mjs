// limits ROUNDS: the daemon in a control group with the limits that octurn.service has on a Raspberry Pi of 1 GB:
// MemoryMax and TasksMax. In each of ROUNDS rounds it scans with all the threads that a setting allows, builds fine
// models by both methods, checks four hostile archives at once, and sends files to many clients. The kernel must not end
// it, and refuse it no thread that a scan needs.
// Ends with status 77 where no control group can be made: that needs root, and the controllers memory and pids.

import {existsSync, mkdirSync, readFileSync, rmdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

import {argument, Daemon, makeFolder, require, sleep} from './daemon.mjs';
import {hostileArchive, importOf} from './archives.mjs';

const rounds = argument(0, 1);
const mb = 2 ** 20;
const machine = 1024; // MB
const service = readFileSync(new URL('../../systemd/octurn.service', import.meta.url), 'utf8');
const share = Number(/^MemoryMax=(\d+)%$/m.exec(service)[1]) / 100;
const tasks = Number(/^TasksMax=(\d+)$/m.exec(service)[1]);
const folder = makeFolder();

/** Removes control groups, whose last process may still be ending. */
function removeGroups(groups) {
  const deadline = Date.now() + 5000;
  for (let left = groups; left.length > 0 && Date.now() < deadline; left = left.filter(existsSync)) {
    for (const group of left) {
      try {
        rmdirSync(group);
      } catch {
        // it has a process yet
      }
    }
  }
}

/**
 * Makes a control group.
 * @returns {{procs: string[], isNew: boolean, has: (file: string) => boolean, read: (file: string) => string}} the files
 *     that a process joins it by, and a reader
 */
function makeGroup() {
  const name = `octurn-attack-${process.pid}`;
  const isNew = existsSync('/sys/fs/cgroup/cgroup.controllers');
  const groups = (isNew ? ['.'] : ['memory', 'pids']).map((controller) => join('/sys/fs/cgroup', controller, name));
  const file = (of) => groups.map((group) => join(group, of)).find(existsSync);
  try {
    groups.forEach((group) => mkdirSync(group));
    process.on('exit', () => removeGroups(groups));
    writeFileSync(file(isNew ? 'memory.max' : 'memory.limit_in_bytes'), String(Math.round(share * machine) * mb));
    writeFileSync(file('pids.max'), String(tasks));
  } catch (error) {
    console.log(`needs root, and a control group with memory and pids: ${error.message}`);
    process.exit(77);
  }
  return {procs: groups.map((group) => join(group, 'cgroup.procs')), isNew, has: (of) => file(of) !== undefined,
    read: (of) => readFileSync(file(of), 'utf8')};
}

const group = makeGroup();
const start = join(folder, 'start');
writeFileSync(start, `#!/bin/sh
for procs in ${group.procs.join(' ')}; do echo $$ >$procs; done
exec ${process.env.OCTURN_PROGRAM} "$@"
`, {mode: 0o755});
process.env.OCTURN_PROGRAM = start;
const killed = () => Number(/oom_kill (\d+)/.exec(group.read(group.isNew ? 'memory.events' : 'memory.oom_control'))[1]);
const refused = () => Number(/max (\d+)/.exec(group.read('pids.events'))[1]);
const peak = () => Number(group.read(group.isNew ? 'memory.peak' : 'memory.max_usage_in_bytes')) / mb;

const daemon = await Daemon.start(folder, {settings: {memory_limit_mb: machine / 2, threads: 256}});
const counts = {models: 0, archives: 0, files: 0};
const before = Number(group.read('pids.current'));
let threads = 0;

/** Counts the tasks; where the kernel keeps no peak, those of now. */
function countTasks() {
  threads = Math.max(threads, Number(group.read(group.has('pids.peak') ? 'pids.peak' : 'pids.current')));
}

/** Builds a model, which may be refused for lack of memory. */
async function build(id, settings) {
  const reply = await daemon.ask('POST', `/api/v1/scans/${id}/builds`, settings);
  require(reply.status === 202, `a build: ${reply.status} ${reply.body}`);
  let {state, error} = reply.json;
  while (state === 'waiting' || state === 'running') {
    countTasks();
    await sleep(20);
    ({state, error} = await daemon.get(reply.headers.location));
  }
  require(state === 'finished' || error?.code === 'memory-limit', `the build is ${state}: ${JSON.stringify(error)}`);
  counts.models += state === 'finished' ? 1 : 0;
}

async function round(archive) {
  const scan = await daemon.whenDone((await daemon.scan({snapshots: 4, frames: 1, leaf_size_mm: 1})).id);
  require(scan.state === 'finished', `the scan is ${JSON.stringify(scan)}`);
  const files = ['scan.zip', 'Scan.stl', 'Scan.3mf', 'Scan.ply', 'coarse.stl', 'thumbnail.png'];
  const cut = ({code}) => ({status: code}); // where connections are too many
  const ask = (file) => daemon.ask('GET', `/api/v1/scans/${scan.id}/${file}`).catch(cut);
  const requests = Array.from({length: 24}, (_, i) => ask(files[i % files.length]));
  // Two are checked at once. Others are refused, perhaps before they are sent whole.
  const archives = Array.from({length: 4}, () => importOf(daemon, archive).catch(cut));
  await build(scan.id, {method: 'intersection', leaf_size_mm: 0.25});
  await build(scan.id, {method: 'solid', leaf_size_mm: 0.5});
  for (const {status} of await Promise.all(archives)) {
    require([400, 503, 'EPIPE', 'ECONNRESET'].includes(status), `a hostile archive: ${status}`);
    counts.archives += 1;
  }
  for (const {status} of await Promise.all(requests)) {
    require([200, 503, 'ECONNRESET'].includes(status), `a file: ${status}`);
    counts.files += status === 200 ? 1 : 0;
  }
}

try {
  const archive = hostileArchive();
  for (let i = 0; i < rounds; ++i) {
    await round(archive);
    require(daemon.isAlive, 'the daemon has ended');
  }
  require(killed() === 0, 'the kernel has killed a process for its memory');
  countTasks();
  require(refused() === 0, `the kernel has refused ${refused()} threads`);
  require(threads > before + 16,
      `only ${threads} threads were seen, of which ${before} before: the setting is not in force`);
  const [status] = await daemon.end();
  require(status === 0, `the daemon ends with ${status}`);
  console.log(`counted: limits: of ${Math.round(share * machine)} MB and ${tasks} tasks at most ` +
    `${peak().toFixed(0)} MB, caches included, and ${threads} tasks; ` +
    `${rounds} rounds, ${counts.models} models, ${counts.archives} archives, ${counts.files} files; ` +
    'nothing killed or refused');
} catch (error) {
  console.error(`limits: ${error.message}\n${daemon.log}`);
  await daemon.end('SIGKILL'); // so that its group can be removed
  process.exit(1);
}
