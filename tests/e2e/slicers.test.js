// Slicers accept models from the API without any repair.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {curaSettings} from './cura_settings.js';
import {scan, startScanner} from './scanner.js';

const run = promisify(execFile);
const everyEdgeMatched = /Total disconnected facets\s*:\s*0\s+0/;
const mended = ['Degenerate facets', 'Edges fixed', 'Facets removed', 'Facets added', 'Facets reversed', 'Backwards edges', 'Normals fixed'];

/** Scans, and resolves to the model's file. */
async function modelOf(scanner, snapshots, method) {
  const {state, model} = await scan(scanner, {snapshots, method, filter: 'basic'});
  assert.equal(state, 'finished');
  const stl = await fetch(new URL(model.url, scanner.url));
  assert.equal(stl.headers.get('Content-Type'), 'model/stl');
  const file = join(scanner.data, `${snapshots}.stl`);
  await writeFile(file, Buffer.from(await stl.arrayBuffer()));
  return file;
}

/** Fails if admesh finds anything to repair, or prusa-slicer finds an open edge. */
async function expectNothingToMend(file) {
  const admesh = (await run('admesh', [file])).stdout;
  assert.match(admesh, everyEdgeMatched);
  for (const what of mended) {
    assert.match(admesh, new RegExp(`${what}\\s*:\\s*0\\b`), what);
  }
  assert.match((await run('prusa-slicer', ['--info', file])).stdout, /manifold = yes/);
}

/** A message that prusa-slicer sometimes logs about the order of its own lines, whatever the model. */
const ofItsOwnLines = /^.*\[error\] +Reversing even wall line.*$/gm;

/** Runs a slicer. @returns its output, and the number of G-code lines that move while printing */
async function slice(program, args, gcode) {
  const {stdout, stderr} = await run(program, args, {maxBuffer: 1 << 28});
  const moves = (await readFile(gcode, 'utf8')).match(/^G1 .*X.*Y.*E/gm) ?? [];
  return {said: stdout + stderr, moves: moves.length};
}

const simulated = {rig: ['--simulate', '--simulate-speed', '30']};

for (const [method, snapshots] of [['intersection', 8], ['intersection', 36], ['solid', 8], ['solid', 36]]) {
  test(`admesh and prusa-slicer accept a model by ${method} of ${snapshots} snapshots without repair`, async (t) => {
    await expectNothingToMend(await modelOf(await startScanner(t, simulated), snapshots, method));
  });
}

test('prusa-slicer and CuraEngine slice a solid model without complaint', async (t) => {
  const file = await modelOf(await startScanner(t, simulated), 8, 'solid');
  const gcode = `${file}.gcode`;
  const prusa = await slice('prusa-slicer',
      ['--export-gcode', '--layer-height', '0.3', '--perimeters', '1', '--fill-density', '0', '-o', gcode, file], gcode);
  assert.doesNotMatch(prusa.said.replaceAll(ofItsOwnLines, ''), /repair|manifold|open edge|error/i);
  assert.ok(prusa.moves > 10000, `${prusa.moves} moves`);

  const cura = await slice('CuraEngine', ['slice', ...curaSettings(), '-o', gcode, '-l', file], gcode);
  assert.doesNotMatch(cura.said, /\[ERROR\]|\[WARNING\] (?!Layer \d+ is empty| -s )/);
  assert.ok(cura.moves > 10000, `${cura.moves} moves`);
});

test('CuraEngine complains of a model that lacks a triangle', async (t) => {
  const file = await modelOf(await startScanner(t, simulated), 8, 'solid');
  const stl = await readFile(file);
  stl.writeUInt32LE(stl.readUInt32LE(80) - 1, 80);
  await writeFile(file, stl.subarray(0, stl.length - 50));
  const cura = await slice('CuraEngine', ['slice', ...curaSettings(), '-o', `${file}.gcode`, '-l', file], `${file}.gcode`);
  assert.match(cura.said, /Mesh has disconnected faces/);
});
