import assert from 'node:assert/strict';
import {test} from 'node:test';

import {coloursOf, deviations, figuresOf} from '../../web/model/deviation.js';
import {Surface} from '../../web/model/nearest.js';
import {readReference} from '../../web/model/reference.js';
import {moved} from '../../web/model/registration.js';
import {bounds} from '../../web/model/stl.js';
import {stlOf} from './mesh_file.js';

/** @param {number[]} numbers */
function meshOf(numbers) {
  const positions = new Float32Array(numbers);
  return {positions, filled: null, ...bounds(positions)};
}

/** A lump without symmetry, 60 mm wide, in `bands` bands. @param {number} bands @param {number} [offset]  along its normals, roughly, millimetres */
function lump(bands, offset = 0) {
  const corner = (/** @type {number} */ band, /** @type {number} */ sector) => {
    const polar = Math.PI * band / bands;
    const isPole = band === 0 || band === bands;
    const angle = isPole ? 0 : Math.PI * (sector % (2 * bands)) / bands;
    const bump = 1 + 0.25 * Math.sin(2 * polar + 1) * Math.cos(angle) + 0.2 * Math.cos(3 * angle + 0.5) * Math.sin(polar) + 0.15 * Math.sin(polar) * Math.sin(angle);
    const radius = 30 * bump + offset;
    const flat = isPole ? 0 : Math.sin(polar);
    return [radius * flat * Math.cos(angle), 0.7 * radius * flat * Math.sin(angle), 1.4 * radius * Math.cos(polar) + 50];
  };
  const numbers = [];
  for (let band = 0; band < bands; ++band) {
    for (let sector = 0; sector < 2 * bands; ++sector) {
      const [a, b, c, d] = [corner(band, sector), corner(band + 1, sector), corner(band + 1, sector + 1), corner(band, sector + 1)];
      band > 0 && numbers.push(...a, ...b, ...d);
      band + 1 < bands && numbers.push(...b, ...c, ...d);
    }
  }
  return meshOf(numbers);
}

const box = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) => {
  const corner = (/** @type {number} */ bits) => [bits & 1 ? x : 0, bits & 2 ? y : 0, bits & 4 ? z : 0];
  return [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
      .map((corners) => corners.map(corner));
};

test('the distance from a box is that of geometry, at its faces, edges and corners, inside and out', () => {
  const surface = new Surface(meshOf(box(20, 30, 40).flat(2)));
  const distance = (/** @type {number[]} */ [x, y, z]) => surface.nearest(x, y, z).distance;
  const expected = ([x, y, z]) => {
    const out = [Math.max(-x, x - 20), Math.max(-y, y - 30), Math.max(-z, z - 40)];
    return Math.max(...out) <= 0 ? Math.max(...out) : Math.hypot(...out.map((value) => Math.max(value, 0)));
  };
  let inside = 0;
  for (let i = 0; i < 2000; ++i) {
    const point = [0.754877666, 0.569840291, 0.362166].map((step, axis) => (i * step % 1) * [40, 60, 80][axis] - [10, 15, 20][axis]);
    assert.ok(Math.abs(distance(point) - expected(point)) < 1e-4, `${point}: ${distance(point)}, not ${expected(point)}`);
    inside += expected(point) < 0 ? 1 : 0;
  }
  assert.ok(inside > 100 && inside < 1900);
});

test('a model that lies anywhere is laid on its reference', () => {
  const [yaw, tilt] = [2.1, 0.7];
  const turn = [Math.cos(tilt) * Math.cos(yaw), -Math.cos(tilt) * Math.sin(yaw), -Math.sin(tilt), 12, Math.sin(yaw), Math.cos(yaw), 0, -30,
    Math.sin(tilt) * Math.cos(yaw), -Math.sin(tilt) * Math.sin(yaw), Math.cos(tilt), 4];
  const reference = lump(60);
  const placed = lump(45);
  const model = meshOf(Array.from({length: placed.positions.length / 3}, (_, i) => moved(turn, ...placed.positions.subarray(3 * i, 3 * i + 3))).flat());
  const {distances, weights} = deviations(model, reference);
  const alone = deviations(placed, reference, {isPlaced: true});
  const [laid, true_] = [figuresOf({distances, weights}, 0.1), figuresOf(alone, 0.1)];
  assert.ok(laid.mean < true_.mean + 0.01, `${laid.mean} mm and, where it lay, ${true_.mean} mm`);
  assert.ok(Math.abs(laid.max - true_.max) < 0.05, `${laid.max} and ${true_.max}`);
});

test('too much material is positive, counted by area, and red; what was filled in does not count', () => {
  const [reference, model] = [lump(40), {...lump(40, 0.5), filled: new Uint8Array(0)}];
  model.filled = new Uint8Array(model.positions.length / 3).map((_, i) => model.positions[3 * i + 2] < 0 ? 255 : 0)
      .map((_, i, all) => Math.max(...all.subarray(3 * Math.floor(i / 3), 3 * Math.floor(i / 3) + 3)));
  const found = deviations(model, reference, {isPlaced: true});
  const {mean, bias, within, histogram} = figuresOf(found, 0.1);
  assert.ok(bias > 0.3 && bias < 0.55 && Math.abs(mean - bias) < 1e-6, `${bias}, ${mean}`);
  assert.ok(within < 0.01, `${within}: but for the poles`);
  assert.ok(Math.abs(histogram.reduce((sum, share) => sum + share, 0) - 1) < 1e-6);
  assert.ok(histogram.at(-1) > 0.5 && histogram[0] === 0);
  assert.ok(figuresOf(found, 1).within === 1);
  const colours = coloursOf(found, 0.1);
  const at = model.filled.findIndex((value, i) => value === 0 && found.distances[i] > 0.3);
  assert.deepEqual([...colours.subarray(3 * at, 3 * at + 3)], [196, 40, 38]);
  assert.equal(found.weights[model.filled.indexOf(255)], 0);
});

test('a reference may be an STL as text, and anything else is refused', async () => {
  const triangles = box(1, 2, 3);
  const words = `solid box\n${triangles.map((corners) => `facet normal 0 0 0\nouter loop\n${corners.map((corner) => `vertex ${corner.join(' ')}`).join('\n')}\nendloop\nendfacet`).join('\n')}\nendsolid`;
  const fromText = await readReference(new TextEncoder().encode(words));
  const fromBytes = await readReference(new Uint8Array(stlOf(triangles)));
  assert.deepEqual(fromText.positions, fromBytes.positions);
  assert.deepEqual([fromText.min, fromText.max], [[0, 0, 0], [1, 2, 3]]);
  for (const wrong of ['', 'solid', 'vertex 1 2 3', words.replace('vertex 1', 'vertex x')]) {
    await assert.rejects(readReference(new TextEncoder().encode(wrong)), /no STL/, wrong);
  }
});
