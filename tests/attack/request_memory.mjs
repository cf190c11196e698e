// request_memory LEAF_MM: of a scan with a large model, whose leaves have that size, asks for everything that the
// interface gives, and sends it archives, one request after the other. None may take more than 100 MB above what the
// idle daemon has. Requests that make a model are not among them: the setting memory_limit_mb is theirs.

import {readFileSync, writeFileSync} from 'node:fs';

import {argument, Daemon, makeFolder, require, requireMemory} from './daemon.mjs';
import {hostileArchive, importOf, manySnapshots} from './archives.mjs';

const leaf = argument(0, 0.5);
const allowed = 100 * 2 ** 20; // bytes
const folder = makeFolder();
const {paths} = JSON.parse(readFileSync(new URL('../../web/openapi.json', import.meta.url)));
const daemon = await Daemon.start(folder);
let moment = '';

/** Resident memory, and its peak since `forgetPeak`, bytes. */
const peak = () => 1024 * Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${daemon.program.pid}/status`, 'utf8'))[1]);
const forgetPeak = () => writeFileSync(`/proc/${daemon.program.pid}/clear_refs`, '5');

/** The addresses of all GETs that end, of this scan. */
function addresses(id) {
  const all = Object.entries(paths).filter(([path, {get}]) => get && path !== '/api/v1/events').map(([path]) => path);
  const formats = ['3mf', 'ply', 'glb', 'obj', 'stl'];
  const filled = all.map((path) => path.replace('{id}', id).replace('{number}', '0'));
  return filled.flatMap((path) =>
    path.includes('{format}') ? formats.map((format) => path.replace('{format}', format)) : [path]);
}

try {
  const {id} = await daemon.scan({snapshots: 6, frames: 1, leaf_size_mm: leaf, method: 'intersection'});
  const scan = await daemon.whenDone(id);
  require(scan.state === 'finished', `the scan is ${JSON.stringify(scan)}`);
  const model = (await daemon.ask('HEAD', `/api/v1/scans/${id}/Scan.stl`)).headers['content-length'];
  const idle = daemon.memory();
  let most = 0;
  let what = '';
  let count = 0;
  let answered = 0; // of a model of a gigabyte, formats that list its corners are refused
  const measure = async (name, action) => {
    moment = name;
    forgetPeak();
    await action();
    const taken = peak() - idle;
    [most, what] = taken > most ? [taken, name] : [most, what];
    requireMemory(taken < allowed, `it takes ${Math.round(taken / 1e6)} MB above ${Math.round(idle / 1e6)} MB`);
    count += 1;
  };
  for (const path of addresses(id)) {
    await measure(`GET ${path}`, async () => {
      const {status} = await daemon.ask('GET', path, undefined, {timeout: 600_000}); // a gigabyte takes minutes in some formats
      require([200, 400, 404, 409, 413, 503].includes(status), `${status}`);
      answered += status === 200 ? 1 : 0;
    });
  }
  const archives = {'hostile archive': hostileArchive(), 'archive of 100 snapshots': manySnapshots(100, 640, 480)};
  for (const [name, archive] of Object.entries(archives)) {
    await measure(name, () => importOf(daemon, archive));
  }
  require(answered > 25, `only ${answered} of them were answered`);
  await daemon.end();
  console.log(`counted: request_memory: ${count} requests, with a model of ${Math.round(model / 1e6)} MB; ` +
    `${Math.round(idle / 1e6)} MB idle, at most ${Math.round(most / 1e6)} MB more, by ${what}`);
} catch (error) {
  console.error(`request_memory: ${moment}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
