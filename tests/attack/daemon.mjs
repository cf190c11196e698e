// `octurn serve` on the simulated rig, the target of the attacks, and the measurements of it.

import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {request as httpRequest} from 'node:http';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {createInterface} from 'node:readline';

const running = new Set(); // programs to be killed at the attack's end
process.on('exit', () => running.forEach((program) => program.kill('SIGKILL')));

const patience = 300_000; // ms, timeout of each wait: beside other work a scan of four stops took more than a minute

/** Fails the attack unless a condition holds. */
export function require(condition, message) {
  if (!condition) {
    throw new Error(message);
  }
}

/** Fails the attack unless the daemon's memory is in bounds. Ignored for a sanitized daemon, as sanitizers take memory, too. */
export function requireMemory(isLittle, message) {
  require(isLittle || process.env.OCTURN_SANITIZED, message);
}

export const sleep = (ms) => new Promise((done) => {
  setTimeout(done, ms);
});

/** Polls until `ask` returns something truthy, and returns that. */
export async function until(ask, what) {
  const deadline = Date.now() + patience;
  for (;;) {
    const answer = await ask();
    if (answer) {
      return answer;
    }
    require(Date.now() < deadline, `waited in vain until ${what}`);
    await sleep(5);
  }
}

/** A folder that is deleted if the attack succeeds. With OCTURN_ATTACK_FOLDER it is created there and kept. */
export function makeFolder() {
  const parent = process.env.OCTURN_ATTACK_FOLDER ?? tmpdir();
  const folder = mkdtempSync(join(parent, 'octurn-attack-'));
  process.on('exit', (code) => {
    if (code === 0 && !process.env.OCTURN_ATTACK_FOLDER) {
      rmSync(folder, {recursive: true, force: true});
    } else {
      process.stderr.write(`what is left is in ${folder}\n`);
    }
  });
  return folder;
}

export class Daemon {
  /**
   * Starts the daemon, and resolves when it serves.
   * @param {string} folder  its working folder
   * @param {{more?: string[], env?: Object, port?: number, settings?: Object}} options
   */
  static async start(folder, {more = [], env = {}, port = 0, settings = {}} = {}) {
    const daemon = new Daemon();
    const config = join(folder, 'octurn.json');
    writeFileSync(config, JSON.stringify(settings));
    const web = join(folder, 'web');
    mkdirSync(web, {recursive: true});
    writeFileSync(join(web, 'index.html'), '<!doctype html><title>Octurn</title>');
    daemon.data = join(folder, 'data');
    daemon.log = '';
    daemon.program = spawn(process.env.OCTURN_PROGRAM,
        ['serve', '--simulate', '--simulate-speed', '50', '--config', config, '--listen', '127.0.0.1', '--port', String(port),
          '--data', daemon.data, '--web', web, ...more], {env: {...process.env, ...env}, stdio: ['ignore', 'pipe', 'pipe']});
    daemon.program.stderr.setEncoding('utf8').on('data', (text) => {
      daemon.log = (daemon.log + text).slice(-20_000);
    });
    running.add(daemon.program);
    daemon.ended = once(daemon.program, 'exit').finally(() => running.delete(daemon.program));
    for await (const line of createInterface({input: daemon.program.stdout})) {
      const found = /http:\/\/[^ ]*:(\d+)\//.exec(line);
      if (found) {
        daemon.port = Number(found[1]);
        return daemon;
      }
    }
    await daemon.ended;
    throw new Error(`octurn ended before it served: ${daemon.log}`);
  }

  get isAlive() {
    return this.program.exitCode === null && this.program.signalCode === null;
  }

  /** Ends the daemon. @returns {Promise<[number|null, string|null]>} exit status and signal */
  async end(signal = 'SIGTERM') {
    this.program.kill(signal);
    const late = setTimeout(() => {
      this.log += `${signal} does not end it`;
      this.program.kill('SIGABRT');
    }, patience);
    const ended = await this.ended;
    clearTimeout(late);
    return ended;
  }

  /**
   * Sends a request with the headers that the page would send.
   * @returns {Promise<{status: number, headers: Object, body: Buffer, json: any}>}
   */
  ask(method, path, body = undefined, {localAddress = '127.0.0.1', timeout = patience} = {}) {
    return new Promise((resolve, reject) => {
      const headers = method === 'GET' ? {} : {'Content-Type': 'application/json'};
      const options = {host: '127.0.0.1', port: this.port, method, path, headers, localAddress, agent: false, timeout};
      const sent = httpRequest(options, (response) => {
        const parts = [];
        response.on('data', (part) => parts.push(part)).on('error', reject).on('end', () => {
          const bytes = Buffer.concat(parts);
          const isJson = (response.headers['content-type'] ?? '').includes('json');
          resolve({status: response.statusCode, headers: response.headers, body: bytes, json: isJson ? JSON.parse(bytes) : null});
        });
      });
      sent.on('timeout', () => sent.destroy(new Error(`${method} ${path} was not answered`))).on('error', reject);
      sent.end(body === undefined ? undefined : JSON.stringify(body));
    });
  }

  /** Sends a GET that must succeed. @returns {Promise<any>} the response's JSON */
  async get(path) {
    const reply = await this.ask('GET', path);
    require(reply.status === 200, `GET ${path}: ${reply.status} ${reply.body.toString('utf8', 0, 500)}`);
    return reply.json;
  }

  /** Starts a scan. @returns {Promise<any>} the scan */
  async scan(settings) {
    const reply = await this.ask('POST', '/api/v1/scans', settings);
    require(reply.status === 202, `POST scans: ${reply.status} ${reply.body}`);
    return reply.json;
  }

  /** Waits until a scan is no longer running. @returns {Promise<any>} the scan then */
  whenDone(id) {
    return until(async () => {
      const scan = await this.get(`/api/v1/scans/${id}`);
      return scan.state === 'running' ? null : scan;
    }, `scan ${id} ends`);
  }

  /** Resident memory, bytes. */
  memory() {
    return Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${this.program.pid}/status`, 'utf8'))[1]) * 1024;
  }

  /** Processor time so far of the first thread, or of the server's, ms: other load of the machine is without effect on it.
   * @param {'main' | 'server'} threads */
  processorTime(threads) {
    const tasks = `/proc/${this.program.pid}/task`;
    let ticks = 0; // of 10 ms
    for (const task of readdirSync(tasks)) {
      const [, name, rest] = /^\d+ \((.*)\) (.*)/.exec(readFileSync(`${tasks}/${task}/stat`, 'utf8'));
      const [user, kernel] = rest.split(' ').slice(11).map(Number);
      const isCounted = threads === 'main' ? Number(task) === this.program.pid : name.startsWith('civetweb');
      ticks += isCounted ? user + kernel : 0;
    }
    return 10 * ticks;
  }

  descriptors() {
    return readdirSync(`/proc/${this.program.pid}/fd`).length;
  }
}

/** The paths of all files below a folder. */
export function filesBelow(folder) {
  return readdirSync(folder, {recursive: true, withFileTypes: true}).filter((entry) => !entry.isDirectory())
      .map((entry) => join(entry.path, entry.name));
}

/** Fails if there is a partial file or a leftover temporary file. */
export function requireWholeFiles(data) {
  for (const file of filesBelow(data)) {
    const name = file.slice(file.lastIndexOf('/') + 1);
    require(!name.startsWith('.'), `${file} was left behind`);
    if (name === 'Scan.stl') {
      const bytes = readFileSync(file);
      require(bytes.length === 84 + 50 * bytes.readUInt32LE(80), `${file} is a part of a model`);
    } else if (name.endsWith('.png')) {
      require(readFileSync(file).subarray(-8, -4).toString('latin1') === 'IEND', `${file} is a part of an image`);
    } else if (name.endsWith('.json')) {
      JSON.parse(readFileSync(file, 'utf8'));
    }
  }
}

/** A numeric argument of the command line, or a default. */
export const argument = (index, otherwise) => Number(process.argv[2 + index] ?? otherwise);
