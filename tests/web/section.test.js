import assert from 'node:assert/strict';
import {test} from 'node:test';

import {boxOf, dot, planeInModel, sectionOf} from '../../web/model/section.js';
import {Matrix4, Vector3} from '../../web/three.js';

const near = (actual, expected, share = 1e-6) =>
  assert.ok(Math.abs(actual - expected) <= share * Math.abs(expected), `${actual} and not ${expected}`);

/** Corners of two triangles for each square of a closed surface over two angles or positions. */
function surface(at, columns, rows) {
  const positions = [];
  for (let i = 0; i < columns; ++i) {
    for (let j = 0; j < rows; ++j) {
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      positions.push(...a, ...b, ...c, ...a, ...c, ...d);
    }
  }
  return positions;
}

const box = ([w, d, h]) => {
  const corner = (index) => [index & 1 ? w : 0, index & 2 ? d : 0, index & 4 ? h : 0];
  return [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
      .flatMap(([a, b, c, d]) => [a, b, c, a, c, d].flatMap(corner));
};

const sides = 720;
const turn = (i) => [Math.cos(2 * Math.PI * i / sides), Math.sin(2 * Math.PI * i / sides)];
const profile = [[0, 0], [15, 0], [15, 40], [0, 40]];  // radius and height
const cylinder = surface((i, j) => [profile[j][0] * turn(i)[0], profile[j][0] * turn(i)[1], profile[j][1]], sides, 3);
const around = (j) => [30 + 8 * turn(j)[0], 8 * turn(j)[1]];
const ring = surface((i, j) => [around(j)[0] * turn(i)[0], around(j)[0] * turn(i)[1], around(j)[1]], sides, sides);

const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

test('a box has its sides as sections', () => {
  const positions = box([40, 25, 10]);
  for (const side of [1, -1]) {
    for (const [axis, at, u, v, width, height] of [[x, 13, y, z, 25, 10], [y, 20, x, z, 40, 10], [z, 5, x, y, 40, 25]]) {
      const section = sectionOf(positions, {normal: axis.map((value) => side * value), distance: side * at}, u, v);
      near(section.width, width);
      near(section.height, height);
      near(section.area, width * height);
    }
  }
  assert.equal(sectionOf(positions, {normal: z, distance: 11}, x, y), null);
  assert.equal(sectionOf(positions, {normal: z, distance: -1}, x, y), null);
});

test('a plane through corners of the mesh cuts as any other', () => {
  const section = sectionOf(cylinder.map((value, i) => i % 3 === 2 ? value - 20 : value), {normal: x, distance: 0}, y, z);
  near(section.area, 30 * 40, 1e-4);
  near(section.width, 30, 1e-4);
});

test('a cylinder has a disc and a rectangle as sections', () => {
  const disc = sectionOf(cylinder, {normal: z, distance: 7}, x, y);
  near(disc.area, Math.PI * 15 ** 2, 1e-4);
  near(disc.width, 30, 1e-4);
  const rectangle = sectionOf(cylinder, {normal: y, distance: 9}, x, z);
  near(rectangle.area, 24 * 40, 1e-4);
  near(rectangle.width, 24, 1e-4);
  near(rectangle.height, 40);
});

test('the section of a ring is two discs upright, and an annulus, without its hole, lying', () => {
  const discs = sectionOf(ring, {normal: y, distance: 0.01}, x, z);
  near(discs.area, 2 * Math.PI * 8 ** 2, 1e-3);
  near(discs.width, 76, 1e-4);
  near(discs.height, 16, 1e-4);
  near(sectionOf(ring, {normal: z, distance: 0.01}, x, y).area, Math.PI * (38 ** 2 - 22 ** 2), 1e-3);
});

test('an open mesh has no area of its section, even where its gaps lie opposite', () => {
  const without = (...columns) => cylinder.filter((_, i) => !columns.includes(Math.floor(i / (3 * 18))));
  for (const open of [without(0), without(100, 100 + sides / 2)]) {
    assert.ok(open.length < cylinder.length);
    const section = sectionOf(open, {normal: z, distance: 7}, x, y);
    assert.equal(section.area, null);
    near(section.width, 30, 1e-3);
    assert.ok(sectionOf(open, {normal: y, distance: 9}, x, z).height > 39);
  }
});

test('a section of a model that was laid is that of the view', () => {
  const turned = new Matrix4().makeRotationAxis(new Vector3(0.48, 0.6, 0.64), 2.2);
  const origin = [3, -8, 21];
  const axes = [x, y, z].map((axis) => new Vector3(...axis).applyMatrix4(turned.clone().invert()).toArray());
  const inView = [];
  for (let i = 0; i < cylinder.length; i += 3) {
    inView.push(...new Vector3(...cylinder.slice(i, i + 3)).applyMatrix4(turned).add(new Vector3(...origin)).toArray());
  }
  const plane = {normal: [0, -1, 0], distance: 2};
  const seen = sectionOf(inView, plane, x, z);
  const told = sectionOf(cylinder, planeInModel(plane, {axes, origin}), axes[0], axes[2]);
  assert.ok(seen.area > 100);
  Object.keys(seen).forEach((name) => near(told[name], seen[name]));
  const [one, other] = [boxOf(inView, {axes: [x, y, z], origin: [0, 0, 0]}), boxOf(cylinder, {axes, origin})];
  one.max.forEach((value, axis) => near(other.max[axis], value, 1e-5));
  one.min.forEach((value, axis) => near(other.min[axis], value, 1e-5));
  assert.equal(dot([1, 2, 3], [4, 5, 6]), 32);
});
