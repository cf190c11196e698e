// fuzz_http REQUESTS [SEED]: sends the real daemon mutated requests of every route while scans run, are resumed and deleted. After
// each batch the daemon must be alive and give its status to another address. No response may have status 500 or invalid JSON. Lists the routes
// that accepted no request: some need what chance seldom makes, such as a second pose that fits.

import {mkdirSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {connect} from 'node:net';
import {join} from 'node:path';
import {gunzipSync} from 'node:zlib';

import {importOf, smallScan, zipOf} from './archives.mjs';
import {argument, Daemon, makeFolder, require, requireMemory} from './daemon.mjs';
import {makeRandom} from './random.mjs';
import {missingRoutes, someRequest} from './requests.mjs';

const total = argument(0, 5000);
const seed = argument(1, 20261123);
const batch = 500;
const together = 12; // fewer than the server lets one address hold
const patience = 100_000; // ms; the server waits less for the rest of an announced body

/** Sends a request. @returns {Promise<Buffer>} all bytes received until the connection ends */
function exchange(port, {bytes, parts, ending}) {
  return new Promise((resolve, reject) => {
    const received = [];
    const socket = connect({host: '127.0.0.1', port, allowHalfOpen: true});
    const slow = setTimeout(() => {
      socket.destroy();
      reject(new Error('a request was not answered, and its connection not closed'));
    }, patience);
    const size = Math.ceil(bytes.length / parts) || 1;
    socket.setNoDelay(true);
    socket.on('connect', async () => {
      for (let at = 0; at < bytes.length; at += size) {
        socket.write(bytes.subarray(at, at + size));
        await new Promise(setImmediate);
      }
      if (ending === 'reset') {
        socket.resetAndDestroy();
      } else {
        socket.end();
      }
    });
    socket.on('data', (part) => received.push(part));
    socket.on('error', () => {}); // the server may close early; its response still counts
    socket.on('close', () => {
      clearTimeout(slow);
      resolve(Buffer.concat(received));
    });
    socket.on('end', () => socket.destroy());
  });
}

/** Checks a response. @returns its status */
function check(answer) {
  const end = answer.indexOf('\r\n\r\n');
  if (end < 0) {
    return 'none';
  }
  const head = answer.toString('latin1', 0, end);
  const status = Number(head.slice(9, 12));
  require(/^HTTP\/1\.1 [1-5]\d\d /.test(head), `the answer begins with ${head.slice(0, 40)}`);
  if (status === 100) {
    return check(answer.subarray(end + 4));
  }
  require(status !== 500, `500: ${answer.toString('utf8', end + 4, end + 500)}`);
  require(head.includes('Content-Security-Policy: default-src'), `without the policy: ${head}`);
  const length = Number(/^Content-Length: (\d+)/im.exec(head)?.[1] ?? 0);
  if (/^Content-Type: application\/(problem\+)?json/im.test(head) && answer.length - end - 4 === length && length > 0) {
    const body = answer.subarray(end + 4);
    JSON.parse((/^Content-Encoding: gzip/im.test(head) ? gunzipSync(body) : body).toString());
  }
  return String(status);
}

const folder = makeFolder();
const root = join(folder, 'appliance'); // its requests are not served; the fuzzer deletes them
mkdirSync(join(root, 'requests'), {recursive: true});
const daemon = await Daemon.start(folder, {more: ['--appliance', root], settings: {memory_limit_mb: 64}});
const random = makeRandom(seed);
const statuses = {};
const accepted = {}; // requests of status 2xx, by route
let sent = 0;
let recent = [];

/** Sends one request after the other until the batch is complete. */
async function sendSome(known, end) {
  while (sent < end) {
    ++sent;
    const request = someRequest(random, known);
    recent.push(request.bytes);
    const status = check(await exchange(daemon.port, request));
    statuses[status] = (statuses[status] ?? 0) + 1;
    accepted[request.route] = (accepted[request.route] ?? 0) + Number(status.startsWith('2'));
  }
}

try {
  require(missingRoutes().length === 0, `no request asks for ${missingRoutes()}`);
  const first = await daemon.whenDone((await daemon.scan({snapshots: 2, frames: 1, leaf_size_mm: 4})).id);
  require(first.state === 'finished', `the first scan is ${JSON.stringify(first)}`);
  const descriptors = daemon.descriptors();
  while (sent < total) {
    recent = [];
    const {scans} = await daemon.get('/api/v1/scans');
    const ids = scans.map((scan) => scan.id);
    if (!scans.some(({state}) => state === 'finished')) {
      await importOf(daemon, zipOf(smallScan())); // without a model most requests have nothing to ask for
    }
    const end = Math.min(total, sent + batch);
    const [key, webhook, printer] = await Promise.all(['keys', 'webhooks', 'printers'].map(async (list) =>
      (await daemon.get(`/api/v1/${list}`))[list].map(({id}) => id)));
    await Promise.all(Array.from({length: together}, () => sendSome({ids, key, webhook, printer, port: daemon.port}, end)));
    require(daemon.isAlive, 'the daemon has ended');
    const status = await daemon.ask('GET', '/api/v1/status', undefined, {localAddress: '127.0.0.2'});
    require(status.status === 200 && status.json.version, `status says ${status.status}`);
    for (const id of ids.slice(40)) {
      await daemon.ask('DELETE', `/api/v1/scans/${id}`);
    }
    for (const name of readdirSync(join(root, 'requests'))) {
      rmSync(join(root, 'requests', name), {force: true});
    }
  }
  const memory = daemon.memory();
  require(daemon.descriptors() <= descriptors + 20, `${daemon.descriptors()} descriptors are open, and were ${descriptors}`);
  requireMemory(memory < 400e6, `${memory} bytes are resident`);
  const [status, signal] = await daemon.end();
  require(status === 0, `SIGTERM ends it with ${status ?? signal}`);
  const never = Object.keys(accepted).filter((route) => accepted[route] === 0);
  for (const route of ['POST /api/v1/scans', 'POST /api/v1/calibration', 'POST /api/v1/scans/{id}/builds', 'POST /api/v1/scans/import']) {
    require(total < 50_000 || accepted[route] > 0, `no ${route} was accepted`);
  }
  console.log(`counted: fuzz_http: ${sent} requests (seed ${seed}), ${Math.round(memory / 1e6)} MB resident, answers ${JSON.stringify(statuses)}; of ` +
    `${Object.keys(accepted).length} routes ${never.length} accepted none: ${never.join(', ')}`);
} catch (error) {
  writeFileSync(join(folder, 'requests.json'), JSON.stringify(recent.map((bytes) => bytes.toString('latin1'))));
  console.error(`fuzz_http: seed ${seed}, request ${sent}: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
