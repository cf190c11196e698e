// What slicers say of a model made through the API, as it comes: with nothing mended.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {setTimeout as wait} from 'node:timers/promises';
import {promisify} from 'node:util';

import {startScanner} from './scanner.js';

const run = promisify(execFile);
const everyEdgeMatched = /Total disconnected facets\s*:\s*0\s+0/;
const mended = ['Degenerate facets', 'Edges fixed', 'Facets removed', 'Facets added', 'Facets reversed', 'Backwards edges', 'Normals fixed'];

/** Scans through the API, and resolves to the model's file. */
async function scan(scanner, snapshots) {
  const api = new URL('/api/v1/', scanner.url);
  const started = await fetch(new URL('scans', api), {
    method: 'POST',
    headers: {'Content-Type': 'application/json'},
    body: JSON.stringify({snapshots, filter: 'basic'}),
  });
  assert.equal(started.status, 202);
  const here = new URL(started.headers.get('Location'), scanner.url);
  let state = 'running';
  for (let polls = 0; state === 'running' && polls < 400; ++polls) {
    await wait(100);
    ({state} = await (await fetch(here)).json());
  }
  assert.equal(state, 'finished');
  const stl = await fetch(`${here}/Scan.stl`);
  assert.equal(stl.headers.get('Content-Type'), 'model/stl');
  const file = join(scanner.data, `${snapshots}.stl`);
  await writeFile(file, Buffer.from(await stl.arrayBuffer()));
  return file;
}

for (const snapshots of [8, 36]) {
  test(`admesh and prusa-slicer accept a model of ${snapshots} snapshots without repair`, async (t) => {
    const file = await scan(await startScanner(t, {rig: ['--simulate', '--simulate-speed', '30']}), snapshots);

    const admesh = (await run('admesh', [file])).stdout;
    assert.match(admesh, everyEdgeMatched);
    for (const what of mended) {
      assert.match(admesh, new RegExp(`${what}\\s*:\\s*0\\b`), what);
    }
    assert.match((await run('prusa-slicer', ['--info', file])).stdout, /manifold = yes/);
  });
}
