import assert from 'node:assert/strict';
import {test} from 'node:test';

import {measure, stlOf} from './mesh_file.js';

const [o, x, y, z] = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]];
const tetrahedron = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]];

test('a tetrahedron is closed, and has a sixth of its box', () => {
  const {triangles, openEdges, volume, min, max} = measure(stlOf(tetrahedron));
  assert.deepEqual({triangles, openEdges, volume, min, max}, {triangles: 4, openEdges: 0, volume: 36, min: o, max: [6, 6, 6]});
});

test('without one side it has three open edges', () => {
  assert.equal(measure(stlOf(tetrahedron.slice(1))).openEdges, 3);
});

test('with one side turned over, its three edges run the same way twice', () => {
  assert.equal(measure(stlOf([[o, x, y], ...tetrahedron.slice(1)])).openEdges, 3);
});

test('a file cut short is refused', () => {
  assert.throws(() => measure(stlOf(tetrahedron).subarray(0, -1)), /283 bytes are not a header and 4 triangles/);
});
