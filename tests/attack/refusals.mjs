// refusals: the data folder has a disk on which a scan, a model or an import has room only without the scans in the bin. Requests that are
// refused, for whatever reason, must change nothing: no scan, setting, key or webhook, and not the bin. The first that is accepted takes the
// bin's oldest scan.

import {execFileSync} from 'node:child_process';
import {writeFileSync} from 'node:fs';
import {connect} from 'node:net';
import {basename, join} from 'node:path';

import {importOf, scanJson, zipOf} from './archives.mjs';
import {Daemon, filesBelow, makeFolder, require} from './daemon.mjs';
import {Faults} from './faults.mjs';

const mb = 2 ** 20;
const folder = makeFolder();
const faults = new Faults(folder, join(folder, 'data'));
const daemon = await Daemon.start(folder, {env: faults.env});
let moment = '';
let count = 0;

/** Makes a scan. @returns {Promise<string>} its id */
async function scanned() {
  const scan = await daemon.whenDone((await daemon.scan({snapshots: 2, frames: 1, leaf_size_mm: 4})).id);
  require(scan.state === 'finished', `it is ${JSON.stringify(scan)}`);
  return scan.id;
}

/** Makes a scan of 100 MB more, and moves it to the bin. @returns {Promise<string>} its id */
async function discarded() {
  const id = await scanned();
  writeFileSync(join(daemon.data, 'scans', id, 'more'), Buffer.alloc(100 * mb));
  require((await daemon.ask('DELETE', `/api/v1/scans/${id}`)).status === 204, `${id} cannot be deleted`);
  return id;
}

const binned = async () => (await daemon.get('/api/v1/bin')).scans.map(({id}) => id);

/** All that a request may change: what the daemon tells, and its files, but for those of a running scan and those being written. */
async function state(running) {
  const scans = (await daemon.get('/api/v1/scans')).scans.map(({id, name, state: now}) => `${id} ${name} ${now}`);
  const {stored, password} = await daemon.get('/api/v1/settings');
  const {keys} = await daemon.get('/api/v1/keys');
  const {webhooks} = await daemon.get('/api/v1/webhooks');
  const files = filesBelow(daemon.data).filter((file) => !file.includes(running) && !basename(file).startsWith('.')).sort();
  return [...scans, JSON.stringify(stored), password, ...await binned(), ...keys.map(({id}) => id), ...webhooks.map(({id}) => id), ...files];
}

/** Of two lists, what one of them lacks. */
const difference = (one, other) => [...one.filter((line) => !other.includes(line)), ...other.filter((line) => !one.includes(line))];

/** Announces an archive of so many bytes, and sends the beginning of one. */
function cutShort(bytes) {
  return new Promise((resolve) => {
    let answer = '';
    const socket = connect({host: '127.0.0.1', port: daemon.port});
    socket.setEncoding('latin1').on('data', (text) => (answer += text)).on('error', () => {});
    socket.on('close', () => resolve({status: Number(answer.slice(9, 12))}));
    socket.end(`POST /api/v1/scans/import HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/zip\r\nContent-Length: ${bytes}\r\n\r\nPK`);
  });
}

/** An archive of that size that is no scan, which only shows when all of it is unpacked. */
const wrongArchive = (bytes) => zipOf([['scan.json', JSON.stringify(scanJson(1, 48, 36))], ['snapshots/000.png', Buffer.alloc(bytes, 'x')]]);

/** Sends requests that must be refused. @param {[string, string, any?][]} requests */
async function requireRefused(running, requests, archives) {
  const before = await state(running);
  for (const [what, ask] of [...requests.map(([method, path, body]) => [`${method} ${path} ${JSON.stringify(body)}`,
    () => daemon.ask(method, `/api/v1/${path}`, body)]), ...archives]) {
    moment = what;
    const {status} = await ask();
    require(status >= 400 && status < 600, `it is not refused: ${status}`);
    const changed = difference(before, await state(running));
    require(changed.length === 0, `it changes ${changed}`);
    count += 1;
  }
}

try {
  const id = await scanned();
  const deleted = [await discarded(), await discarded()];
  await daemon.ask('POST', '/api/v1/keys', {name: 'a program', access: 'read'});
  await daemon.ask('POST', '/api/v1/webhooks', {url: 'http://127.0.0.1:9/hook'});
  await daemon.ask('PATCH', '/api/v1/settings', {scan: {frames: 1}});
  const running = await daemon.scan({snapshots: 400, frames: 1, leaf_size_mm: 4});
  const taken = Number(execFileSync('du', ['-sB1', daemon.data], {encoding: 'utf8'}).split('\t')[0]);
  faults.setDisk(taken + 60 * mb); // a model is given 128
  const send = (bytes) => importOf(daemon, wrongArchive(bytes)).catch(() => ({status: 503})); // it is cut off before it is sent whole
  const archives = [['an archive of 25 MB', () => send(25 * mb)], ['one of 5 MB', () => send(5 * mb)], ['one of 70 MB that does not come', () => cutShort(70 * mb)], ['one of 5 MB that does not come', () => cutShort(5 * mb)]];
  await requireRefused(running.id, [
    ['POST', 'scans', {}], ['POST', `scans/${id}/builds`, {}], ['POST', `scans/${id}/poses`, {}], ['POST', `scans/${id}/resume`],
    ['POST', `scans/${id}/restore`], ['POST', `scans/${deleted[0]}/resume`], ['DELETE', `scans/${running.id}`], ['DELETE', `scans/${id}/builds/0`],
    ['POST', 'calibration', {kind: 'turn'}], ['PATCH', `scans/${id}`, {name: 'a name', notes: 5}], ['PATCH', 'settings', {scan: {frames: 0}}],
    ['PATCH', 'settings', {scan: {frames: 2}, nonsense: 1}], ['PUT', 'settings/password', {password: 'short'}], ['POST', 'settings/backup', {}],
    ['POST', 'keys', {name: 'b', access: 'all'}], ['POST', 'webhooks', {url: 'ftp://a'}], ['DELETE', 'keys/x'], ['DELETE', 'webhooks/x']], archives);
  await daemon.ask('POST', `/api/v1/scans/${running.id}/cancel`);
  await daemon.whenDone(running.id);
  await requireRefused(running.id, [['POST', 'scans', {snapshots: 400}], ['POST', 'scans', {leaf_size_mm: 0}],
    ['POST', `scans/${id}/builds`, {leaf_size_mm: 0}], ['POST', `scans/${id}/poses`, {snapshots: 400}]], archives);
  moment = 'a build';
  const build = await daemon.ask('POST', `/api/v1/scans/${id}/builds`, {leaf_size_mm: 8});
  require(build.status === 202, `${build.status} ${build.body}`);
  require((await binned()).join() === deleted[1], `in the bin are ${await binned()}, and were ${deleted}`);
  await daemon.end();
  console.log(`counted: refusals: ${count} requests refused on a disk with too little room, nothing changed`);
} catch (error) {
  console.error(`refusals: ${moment}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
