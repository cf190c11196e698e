// clock_jumps JUMPS [SEED]: lets the time of day jump by up to centuries while the daemon scans. Scans must finish, report their
// true duration, and be listed in the order in which they were made.

import {join} from 'node:path';

import {argument, Daemon, makeFolder, require, requireWholeFiles, sleep} from './daemon.mjs';
import {Faults} from './faults.mjs';
import {makeRandom} from './random.mjs';

const jumps = argument(0, 4);
const seed = argument(1, 20261123);
const random = makeRandom(seed);
const folder = makeFolder();
const year = 31_556_952; // seconds
const faults = new Faults(folder, join(folder, 'data'));
const made = [];
let daemon = await Daemon.start(folder, {env: faults.env});
let years = 0;

try {
  for (let i = 0; i < jumps; ++i) {
    const {id} = await daemon.scan({snapshots: 3, frames: 1, leaf_size_mm: 4});
    await sleep(random.below(300));
    years = random.pick([-50, -1, -1e-4, 0, 1e-4, 0.5, 11, 75, 230]);
    faults.setClock(Math.round(years * year));
    const scan = await daemon.whenDone(id);
    require(scan.state === 'finished', `the scan is ${JSON.stringify(scan)}`);
    require(scan.seconds_elapsed >= 0 && scan.seconds_elapsed < 120, `it lasted ${scan.seconds_elapsed} s`);
    made.unshift(id);
    const listed = (await daemon.get('/api/v1/scans')).scans.map((other) => other.id);
    require(JSON.stringify(listed) === JSON.stringify(made), `listed are ${listed}, made were ${made}`);
    require((await daemon.get('/api/v1/status')).newest === id, 'the newest is another');
    require((await daemon.ask('GET', '/Scan.stl')).status === 200, 'it has no model');
    require((await daemon.ask('GET', '/api/v1/diagnostics.zip')).status === 200, 'there are no diagnostics');
    if (i % 4 === 3) {
      const [status, signal] = await daemon.end();
      require(status === 0, `it ends with ${status ?? signal}`);
      daemon = await Daemon.start(folder, {env: faults.env});
    }
  }
  requireWholeFiles(daemon.data);
  await daemon.end();
  console.log(`counted: clock_jumps: ${jumps} jumps (seed ${seed}), ${made.length} scans in order`);
} catch (error) {
  console.error(`clock_jumps: seed ${seed}: ${years} years: ${error.message}\n${daemon.log}`);
  process.exit(1);
}
