// slow_clients CLIENTS LOOKS: for each kind of client that keeps a server waiting, CLIENTS of them connect at once, from one address and
// from as many addresses, and reconnect when they are cut off. Meanwhile another address requests the page LOOKS times and must be
// answered; the times are printed.

import {connect} from 'node:net';

import {argument, Daemon, makeFolder, require, sleep, until} from './daemon.mjs';

const clients = argument(0, 200);
const looks = argument(1, 10);
const folder = makeFolder();
const visitor = '127.0.0.77';

const post = (type, length) => `POST /api/v1/scans HTTP/1.1\r\nHost: localhost\r\nContent-Type: ${type}\r\nContent-Length: ${length}\r\n\r\n`;
const get = (path) => `GET ${path} HTTP/1.1\r\nHost: localhost\r\n\r\n`;

/**
 * The kinds of clients: what each sends at once, what it sends every `every` ms, and whether it reads the response.
 * @param {string} model  the path of a large file
 */
const kinds = (model) => ({
  silent: {},
  'half a head': {says: 'GET / HTTP/1.1\r\nHost: lo'},
  'a dripped head': {says: 'GET / HTTP/1.1\r\n', drips: 'A: b\r\n', every: 200},
  'a body that never comes': {says: post('application/json', 300)},
  'a dripped body': {says: post('application/json', 3000), drips: ' ', every: 200},
  'an endless body of no use': {says: post('application/octet-stream', 1e9), drips: 'x', every: 200},
  'a model that is not read': {says: get(model), isDeaf: true},
  'doctors': {says: get('/api/v1/doctor')},
  'whole requests': {says: get('/'), leaves: true},
});

/** Clients of one kind that reconnect until they are told to end. */
class Crowd {
  #isEnding = false;
  #sockets = new Set();

  constructor(port, kind, addresses) {
    this.cut = 0;
    this.clients = Array.from({length: clients}, (_, index) => this.#come(port, kind, addresses(index)));
  }

  async #come(port, {says, drips, every, isDeaf, leaves}, localAddress) {
    while (!this.#isEnding) {
      const socket = connect({host: '127.0.0.1', port, localAddress});
      this.#sockets.add(socket);
      socket.on('error', () => {});
      const closed = new Promise((done) => {
        socket.once('close', done);
      });
      if (isDeaf) {
        socket.pause();
      } else {
        socket.on('data', () => leaves && socket.destroy());
      }
      if (says) {
        socket.write(says);
      }
      const timer = drips && setInterval(() => socket.write(drips), every);
      await closed;
      clearInterval(timer);
      this.#sockets.delete(socket);
      this.cut += 1;
      await sleep(20);
    }
  }

  async end() {
    this.#isEnding = true;
    this.#sockets.forEach((socket) => socket.destroy());
    await Promise.all(this.clients);
  }
}

/** The durations of requests for the page and the status, ms. */
async function timesOf(daemon) {
  const times = [];
  for (let i = 0; i < looks; ++i) {
    for (const path of ['/', '/api/v1/status']) {
      const begin = performance.now();
      const reply = await daemon.ask('GET', path, undefined, {localAddress: visitor});
      require(reply.status === 200, `GET ${path}: ${reply.status} ${reply.body}`);
      times.push(performance.now() - begin);
    }
  }
  return times.sort((a, b) => a - b);
}

const told = (times) => `${times[times.length >> 1].toFixed(0)} (${times.at(-1).toFixed(0)})`;

const daemon = await Daemon.start(folder);
try {
  const {id} = await daemon.scan({snapshots: 2, frames: 1, leaf_size_mm: 1, method: 'intersection'});
  const scan = await daemon.whenDone(id);
  require(scan.state === 'finished', `the scan ends as ${JSON.stringify(scan)}`);
  const model = `/api/v1/scans/${id}/Scan.stl`;
  const lines = [`nobody ${told(await timesOf(daemon))}`];
  for (const [name, kind] of Object.entries(kinds(model))) {
    const found = [];
    for (const addresses of [() => '127.0.0.1', (index) => `127.1.${index >> 7}.${1 + (index & 127)}`]) {
      const crowd = new Crowd(daemon.port, kind, addresses);
      await sleep(200);
      found.push(told(await timesOf(daemon)));
      require(daemon.isAlive, `the daemon has ended: ${daemon.log}`);
      await crowd.end();
    }
    lines.push(`${name} ${found.join(', ')}`);
  }
  await until(async () => daemon.descriptors() < 40, 'the daemon has closed the connections');
  const [status] = await daemon.end();
  require(status === 0, `the daemon ends with ${status}: ${daemon.log}`);
  console.log(`counted: slow_clients: ${clients} of each kind, from one address, and from many; ms until the page is there, median ` +
    `(longest): ${lines.join('; ')}`);
} catch (error) {
  console.error(`slow_clients: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
