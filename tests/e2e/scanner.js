// Starts Octurn for a test on the simulated rig, on loopback and with a temporary data folder.

import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {mkdtemp, readdir, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {createInterface} from 'node:readline';

/** Resolves to the address that the program prints; rejects with its output if it ends before. */
async function address(program) {
  let said = '';
  for (const stream of [program.stdout, program.stderr]) {
    stream.setEncoding('utf8').on('data', (text) => {
      said += text;
    });
  }
  for await (const line of createInterface({input: program.stdout})) {
    const url = /http:\/\/[^ ]+/.exec(line);
    if (url) {
      return url[0];
    }
  }
  throw new Error(`octurn ended before it served: ${said}`);
}

/**
 * @typedef {Object} Scanner
 * @property {string} url  of the page
 * @property {string} data  the folder it works in
 * @property {() => number} process  its number
 * @property {(signal?: NodeJS.Signals) => Promise<void>} end
 * @property {() => Promise<void>} restart  at the same address, with the same folder
 */

/** Faster than life, for a test that waits for scans. Such a rig draws more pictures, also of those that nobody looks at. */
export const quick = {rig: ['--simulate', '--simulate-speed', '8']};

/**
 * @param {import('node:test').TestContext} t  at its end the scanner is stopped and its folder deleted
 * @param {{rig?: string[]}} options  rig: the arguments that choose devices; by default in real time, in which a scan lasts longer than a
 *     browser on a busy machine needs to show it
 * @returns {Promise<Scanner>}
 */
export async function startScanner(t, {rig = ['--simulate']} = {}) {
  const path = process.env.OCTURN_PROGRAM;
  if (!path) {
    throw new Error('OCTURN_PROGRAM must be the path of the program octurn');
  }
  const data = await mkdtemp(join(tmpdir(), 'octurn-e2e-'));
  // No test of the page is about optics: the simulated Kinect has its data sheet's.
  const sensor = rig.includes('--simulate') ? ['--simulate-unit', '0'] : [];
  const run = (port) => spawn(path, ['serve', ...rig, ...sensor, '--listen', '127.0.0.1', '--port', String(port), '--data', data]);
  let program = run(0);
  const scanner = {
    url: '',
    data,
    process: () => program.pid,
    end: async (signal = 'SIGTERM') => {
      if (program.exitCode === null && program.signalCode === null) {
        program.kill(signal);
        await once(program, 'exit');
      }
    },
    restart: async () => {
      program = run(new URL(scanner.url).port);
      await address(program);
    },
  };
  t.after(async () => {
    await scanner.end();
    await rm(data, {recursive: true, force: true});
  });
  scanner.url = await address(program);
  return scanner;
}

/** @returns {Promise<void>} */
const pause = () => new Promise((done) => {
  setTimeout(done, 200);
});

/**
 * Calls the API. On a busy machine a scanner that has just started may have no frame in time: it is asked again, as it says.
 * @returns {Promise<any>} the response's body
 */
export async function ask(scanner, path, method = 'GET', body = undefined) {
  // A test that is busy for seconds would not notice that the server closed a kept-alive connection meanwhile.
  const response = await fetch(`${scanner.url}api/v1/${path}`,
      {method, headers: {'Content-Type': 'application/json', 'Connection': 'close'}, body: body && JSON.stringify(body)});
  if (!response.ok) {
    const problem = await response.text();
    if (response.status === 503 && problem.includes('the sensor has sent no frame yet')) {
      await pause();
      return ask(scanner, path, method, body);
    }
    throw new Error(`${method} ${path}: ${response.status} ${problem}`);
  }
  return response.status === 204 ? null : response.json();
}

/** @param {Scanner} scanner @returns {Promise<string[]>} the paths of its scans' folders */
export async function scanFolders(scanner) {
  const folder = join(scanner.data, 'scans');
  return (await readdir(folder)).map((name) => join(folder, name));
}

/** Runs a whole scan without the page. @returns {Promise<any>} the scan at its end */
export async function scan(scanner, settings) {
  let job = await ask(scanner, 'scans', 'POST', settings);
  while (job.state === 'running') {
    await pause();
    job = await ask(scanner, `scans/${job.id}`);
  }
  return job;
}
