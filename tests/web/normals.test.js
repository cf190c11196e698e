import assert from 'node:assert/strict';
import {test} from 'node:test';

import {smoothNormals} from '../../web/model/normals.js';

/** The normal of a corner, as numbers from -1 to 1. */
const at = (normals, corner) => Array.from(normals.subarray(3 * corner, 3 * corner + 3), (n) => n / 32767);

const near = (actual, expected) => actual.forEach((n, i) => assert.ok(Math.abs(n - expected[i]) < 1e-3, `${actual} is not ${expected}`));

/** Two triangles that share the edge from (0, 0, 0) to (0, 1, 0): one flat, one that leaves it at an angle. */
const roof = (degrees) => {
  const [x, z] = [Math.cos(degrees * Math.PI / 180), -Math.sin(degrees * Math.PI / 180)];
  return new Float32Array([0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 0, x, 0, z, 0, 1, 0]);
};

test('triangles that meet at a small angle share the normals of their edge', () => {
  const normals = smoothNormals(roof(20));
  const mean = [Math.sin(10 * Math.PI / 180), 0, Math.cos(10 * Math.PI / 180)];
  [0, 1, 3, 5].forEach((corner) => near(at(normals, corner), mean));
  near(at(normals, 2), [0, 0, 1]);
});

test('triangles that meet at a large angle keep their edge', () => {
  const normals = smoothNormals(roof(60));
  [0, 1, 2].forEach((corner) => near(at(normals, corner), [0, 0, 1]));
  [3, 4, 5].forEach((corner) => near(at(normals, corner), [Math.sin(Math.PI / 3), 0, Math.cos(Math.PI / 3)]));
});

test('a larger triangle counts more', () => {
  const two = roof(20);
  two.set([10 * two[12], 0, 10 * two[14]], 12);
  assert.ok(at(smoothNormals(two), 0)[0] > at(smoothNormals(roof(20)), 0)[0]);
});

test('a triangle without area has no normal, and a hundred thousand corners at one place end', () => {
  const degenerate = smoothNormals(new Float32Array(9));
  assert.deepEqual(Array.from(degenerate), Array(9).fill(0));
  const fan = new Float32Array(9 * 100_000).map((_, i) => i % 9 < 3 ? 0 : Math.sin(i));
  assert.equal(smoothNormals(fan).length, fan.length);
});
