import assert from 'node:assert/strict';
import {test} from 'node:test';

import {readStl} from '../../web/model/stl.js';
import {stlOf} from './mesh_file.js';

const triangles = [
  [[0, 0, 0], [6, 0, 0], [0, 6, 0]],
  [[-1.5, 0, 0], [0, 2, 9], [0, 1, 0]],
  [[1, 2, 3], [4, 5, 6], [7, 8, 10]],
];
const file = stlOf(triangles);

async function* inPieces(bytes, size) {
  for (let at = 0; at < bytes.length; at += size) {
    yield bytes.subarray(at, at + size);
  }
}

test('the positions are those of the file, however it arrives', async () => {
  for (let size = 1; size <= file.length; ++size) {
    const {positions, min, max} = await readStl(inPieces(file, size));
    assert.deepEqual([...positions], triangles.flat(2), `in pieces of ${size}`);
    assert.deepEqual([min, max], [[-1.5, 0, 0], [7, 8, 10]]);
  }
});

test('corners of triangles that were filled in are marked', async () => {
  const marked = Buffer.from(file);
  marked[84 + 50 + 48] = 1;  // the attributes of the second triangle
  assert.equal((await readStl(inPieces(file, 7))).filled, null);
  assert.deepEqual([...(await readStl(inPieces(marked, 7))).filled ?? []], [0, 0, 0, 255, 255, 255, 0, 0, 0]);
});

test('every file cut short is refused', async () => {
  for (let length = 0; length < file.length; ++length) {
    await assert.rejects(readStl(inPieces(file.subarray(0, length), 64)), /cut short/, `${length} bytes`);
  }
});

test('a file that goes on after its last triangle is refused', async () => {
  await assert.rejects(readStl(inPieces(Buffer.concat([file, Buffer.alloc(1)]), 1000)), /goes on/);
});

test('a file without triangles is refused', async () => {
  await assert.rejects(readStl(inPieces(stlOf([]), 1000)), /empty/);
});

test('progress grows to the whole', async () => {
  const shares = [];
  await readStl(inPieces(file, 50), (share) => shares.push(share));
  assert.deepEqual(shares, [...shares].sort((a, b) => a - b));
  assert.equal(shares.at(-1), 1);
});
