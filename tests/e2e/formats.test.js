// Other programs read a model's formats: they find the STL's triangles and report no problems.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';
import {validateBytes} from 'gltf-validator';

import {scan, startScanner} from './scanner.js';

const run = promisify(execFile);

/** The output of prusa-slicer --info. @returns {Promise<Record<string, string>>} */
async function slicerInfo(file) {
  const {stdout} = await run('prusa-slicer', ['--info', file]);
  return Object.fromEntries([...stdout.matchAll(/^(\w+) = (.*)$/gm)].map(([, name, value]) => [name, value.trim()]));
}

/** Writes the corners of all triangles that Open3D reads, three floats each. */
const cornersByOpen3d = `
import sys, numpy, open3d
mesh = open3d.io.read_triangle_mesh(sys.argv[1])
numpy.asarray(mesh.vertices)[numpy.asarray(mesh.triangles)].astype("<f4").tofile(sys.argv[2])
`;

/** Triangles in an order that does not depend on the file. @param {(index: number) => Buffer} cornersOf */
const sorted = (count, cornersOf) => Buffer.concat(Array.from({length: count}, (_, index) => cornersOf(index)).sort(Buffer.compare));

test("Khronos's validator, prusa-slicer and Open3D agree with the STL", async (t) => {
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

  const ply = join(scanner.data, 'model.ply');
  await writeFile(ply, await fetched('Scan.ply'));
  await run('/usr/bin/python3', ['-c', cornersByOpen3d, ply, `${ply}.corners`]);
  const corners = await readFile(`${ply}.corners`);
  assert.equal(corners.length, 36 * triangles);
  const ofPly = sorted(triangles, (index) => corners.subarray(36 * index, 36 * (index + 1)));
  assert.ok(ofPly.equals(sorted(triangles, (index) => stl.subarray(84 + 50 * index + 12, 84 + 50 * index + 48))));
});
