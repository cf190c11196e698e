// What readers of others make of a model's formats: the same triangles as the STL's, and nothing to complain of.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';
import {validateBytes} from 'gltf-validator';

import {scan, startScanner} from './scanner.js';

const run = promisify(execFile);

/** What prusa-slicer tells of a file. @returns {Promise<Record<string, string>>} */
async function slicerInfo(file) {
  const {stdout} = await run('prusa-slicer', ['--info', file]);
  return Object.fromEntries([...stdout.matchAll(/^(\w+) = (.*)$/gm)].map(([, name, value]) => [name, value.trim()]));
}

test("Khronos's validator, prusa-slicer and a plain reader agree with the STL", async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '30']});
  const {id} = await scan(scanner, {snapshots: 8, filter: 'basic', leaf_size_mm: 2});
  const fetched = async (name) => Buffer.from(await (await fetch(`${scanner.url}api/v1/scans/${id}/${name}`)).arrayBuffer());
  const stl = await fetched('Scan.stl');
  const triangles = stl.readUInt32LE(80);

  const {issues, info} = await validateBytes(new Uint8Array(await fetched('Scan.glb')));
  assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], JSON.stringify(issues.messages));
  assert.equal(info.totalTriangleCount, triangles);

  const ofStl = await (async () => {
    await writeFile(join(scanner.data, 'model.stl'), stl);
    return slicerInfo(join(scanner.data, 'model.stl'));
  })();
  await writeFile(join(scanner.data, 'model.3mf'), await fetched('Scan.3mf'));
  const of3mf = await slicerInfo(join(scanner.data, 'model.3mf'));
  assert.equal(of3mf.manifold, 'yes');
  assert.equal(of3mf.number_of_facets, String(triangles));
  for (const key of ['size_x', 'size_y', 'size_z', 'volume']) {
    assert.ok(Math.abs(of3mf[key] / ofStl[key] - 1) < 1e-4, `${key}: ${of3mf[key]} and ${ofStl[key]}`);
  }

  const ply = await fetched('Scan.ply');
  assert.match(ply.subarray(0, 400).toString('latin1'), new RegExp(`element face ${triangles}\n`));
});
