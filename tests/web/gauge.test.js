import assert from 'node:assert/strict';
import {test} from 'node:test';

import {gaugeSizes} from '../../web/model/gauge.js';

/** A grid of points as triangles. @param {number} count  per side @param {(u: number, v: number) => number[]} at  u, v from 0 to 1 */
function grid(count, at) {
  const positions = [];
  for (let i = 0; i < count; ++i) {
    for (let j = 0; j < count; ++j) {
      const [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([u, v]) => at(u / count, v / count));
      positions.push(...a, ...b, ...c, ...a, ...c, ...d);
    }
  }
  return positions;
}

let state = 1;
const noise = (size) => size * ((state = state * 48271 % 2147483647) / 2147483647 - 0.5);

/** A turned block on z = 0 whose faces are rough. */
function block([length, width, height], {turn, rough}) {
  const turned = (x, y, z) => [x * Math.cos(turn) - y * Math.sin(turn) + 7, x * Math.sin(turn) + y * Math.cos(turn) - 4, z];
  const [l, w] = [length / 2, width / 2];
  const count = 40;
  return [
    (u, v) => turned(l * (2 * u - 1), -w + noise(rough), height * v),
    (u, v) => turned(l * (1 - 2 * u), w + noise(rough), height * v),
    (u, v) => turned(l + noise(rough), w * (2 * u - 1), height * v),
    (u, v) => turned(-l + noise(rough), w * (1 - 2 * u), height * v),
    (u, v) => turned(l * (2 * u - 1), w * (2 * v - 1), height + noise(rough)),
    (u, v) => turned(l * (2 * u - 1), w * (1 - 2 * v), 0),
  ].flatMap((at) => grid(count, at));
}

const ball = (radius) => grid(80, (u, v) => {
  const [around, down] = [2 * Math.PI * u, Math.PI * (1 - v)];
  return [radius * Math.sin(down) * Math.cos(around), radius * Math.sin(down) * Math.sin(around), radius * (1 + Math.cos(down))];
});
const meshOf = (positions, filled = null) => ({positions: Float32Array.from(positions), filled, min: [], max: []});

test('a block is measured between its faces, however it is turned', () => {
  for (const turn of [0, 0.3, -0.6, Math.PI / 4, 2]) {
    const {kind, sizes} = gaugeSizes(meshOf(block([60, 45, 123], {turn, rough: 0.4})));
    assert.equal(kind, 'block', `${turn}`);
    [60, 45, 123].forEach((size, i) => assert.ok(Math.abs(sizes[i] - size) < 0.05, `${turn}: ${sizes}`));
  }
});

test('a surface that was filled in is not measured', () => {
  const positions = block([60, 45, 30], {turn: 0.2, rough: 0});
  const plank = grid(10, (u, v) => [-100, 100 * u, 30 * v + 3]);
  const filled = new Uint8Array((positions.length + plank.length) / 3).fill(255, positions.length / 3);
  const {kind, sizes} = gaugeSizes(meshOf([...positions, ...plank], filled));
  assert.deepEqual([kind, sizes.map((size) => size.toFixed(2))], ['block', ['60.00', '45.00', '30.00']]);
});

test('a ball has one size', () => {
  const {kind, sizes} = gaugeSizes(meshOf(ball(25)));
  assert.equal(kind, 'ball');
  assert.ok(Math.abs(sizes[0] - 50) < 0.1, `${sizes}`);
});

test('other shapes are neither a block nor a ball', () => {
  const roof = grid(60, (u, v) => [60 * (u - 0.5), 45 * (v - 0.5), 60 - 80 * Math.abs(u - 0.5)]);
  const cylinder = grid(80, (u, v) => [30 * Math.cos(2 * Math.PI * u), 30 * Math.sin(2 * Math.PI * u), 60 * v]);
  for (const positions of [roof, cylinder]) {
    assert.deepEqual(gaugeSizes(meshOf(positions)), {kind: 'neither', sizes: []});
  }
});
