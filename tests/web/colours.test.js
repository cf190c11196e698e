import assert from 'node:assert/strict';
import {test} from 'node:test';

import {readColours} from '../../web/model/colours.js';

/** A PLY as the scanner writes it. @param {{colours: number[][], faces: number[][], head?: string}} model @returns {ArrayBuffer} */
function ply({colours, faces, head = 'property uchar red\nproperty uchar green\nproperty uchar blue\n', comments = ''}) {
  const text = `ply\nformat binary_little_endian 1.0\ncomment millimetres, Z up\n${comments}element vertex ${colours.length}
property float x\nproperty float y\nproperty float z\n${head}element face ${faces.length}
property list uchar uint vertex_indices\nproperty uchar filled\nend_header\n`;
  const vertices = colours.map((colour) => [...Buffer.from(new Float32Array([10, 13, 3.25]).buffer), ...colour]);
  const corners = faces.map((indices) => [3, ...Buffer.from(new Uint32Array(indices).buffer), 0]);
  return new Uint8Array([...Buffer.from(text), ...vertices.flat(), ...corners.flat()]).buffer;
}

const model = {colours: [[1, 2, 3], [4, 5, 6], [7, 8, 9], [10, 13, 250]], faces: [[0, 1, 2], [3, 2, 1]]};

test('each corner of each triangle gets the colour of its vertex, in the order of the faces', () => {
  assert.deepEqual([...readColours(ply(model))], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 13, 250, 7, 8, 9, 4, 5, 6]);
});

test('what somebody wrote about the scan does not matter', () => {
  const comments = ['name element vertex 99', `author ${'ü'.repeat(100)}`, `licence ${'\u{1F3FA}'.repeat(100)}`, 'inventory number end_header']
      .map((words) => `comment ${words}\n`).join('').repeat(2);
  assert.deepEqual(readColours(ply({...model, comments})), readColours(ply(model)));
});

test('a file that is cut short, goes on, or has no colours is refused', () => {
  const whole = ply(model);
  for (let bytes = 0; bytes < whole.byteLength; bytes += 7) {
    assert.throws(() => readColours(whole.slice(0, bytes)), /cut short/);
  }
  assert.throws(() => readColours(new Uint8Array([...new Uint8Array(whole), 0]).buffer));
  assert.throws(() => readColours(ply({...model, head: ''})));
});
