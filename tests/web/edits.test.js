import assert from 'node:assert/strict';
import {test} from 'node:test';

import {isEdited} from '../../web/scan/builds.js';
import {composed, planesOf, restOf} from '../../web/scan/edits.js';
import {Matrix4, Vector3} from '../../web/three.js';

/** The place that an edited model's point has, by three.js: laid by the smallest rotation, then scaled. */
function placed({lay_mm, scale}, point) {
  const place = new Vector3(...point);
  if (lay_mm) {
    const [down, origin] = [new Vector3(...lay_mm.slice(0, 3)), new Vector3(...lay_mm.slice(3))];
    const axis = down.clone().cross(new Vector3(0, 0, -1));
    const turn = down.z > 0.9999 ? new Matrix4().makeRotationX(Math.PI) :
      new Matrix4().makeRotationAxis(axis.clone().normalize(), Math.atan2(axis.length(), -down.z));
    place.sub(origin).applyMatrix4(turn);
  }
  return place.multiplyScalar(scale ?? 1).toArray();
}

const near = (actual, expected, off = 1e-9) =>
  actual.forEach((value, axis) => assert.ok(Math.abs(value - expected[axis]) < off, `${actual} and not ${expected}`));
const along = ([x, y, z, distance], point) => x * point[0] + y * point[1] + z * point[2] - distance;

const before = {cut_mm: [[0, 0, 1, 90]], erase_mm: [], lay_mm: [0.6, 0, 0.8, 10, -20, 30], scale: 2};

test('a cut of a model that was laid and scaled is told in the frame of the model as scanned', () => {
  const cut = {normal: [0, 0.6, 0.8], distance: 12};
  const {cut_mm, lay_mm, scale} = composed(before, {cut, erased: [], lay: null});
  assert.deepEqual([cut_mm.length, cut_mm[0], lay_mm, scale], [2, [0, 0, 1, 90], before.lay_mm, 2]);
  for (const point of [[0, 0, 0], [30, -4, 55], [-7, 12, 3]]) {
    const inView = along([...cut.normal, cut.distance], placed(before, point));
    assert.ok(Math.abs(inView - 2 * along(cut_mm[1], point)) < 1e-9);
  }
});

test('balls are erased where they are seen, in a model that is turned over, too', () => {
  for (const lay_mm of [before.lay_mm, [0, 0, 1, 5, 6, 70], null]) {
    const seen = {...before, lay_mm};
    const point = [12, -30, 44];
    const {erase_mm} = composed(seen, {cut: null, erased: [[...placed(seen, point), 8]], lay: null});
    near(erase_mm[0], [...point, 4]);
  }
});

test('a model that is laid again rests on the side that is down in the view', () => {
  const down = [0.48, 0.6, 0.64];
  const origin = [4, 5, 6];  // of the view, in the frame of the model in view
  const {lay_mm, scale} = composed(before, {cut: null, erased: [], lay: {down, point: origin}});
  const [a, b] = [[1, 2, 3], [-20, 8, 40]];
  near(placed({lay_mm, scale}, a).map((value) => value ** 2).reduce((sum, value) => [sum[0] + value], [0]),
      [placed(before, a).map((value, axis) => (value - origin[axis]) ** 2).reduce((sum, value) => sum + value)], 1e-6);
  const depth = (point) => placed(before, point).reduce((sum, value, axis) => sum + (value - origin[axis]) * down[axis], 0);
  for (const point of [a, b]) {
    assert.ok(Math.abs(placed({lay_mm, scale}, point)[2] + depth(point)) < 1e-9);
  }
});

test('a model comes to rest below its middle', () => {
  const corners = [-1, 1].flatMap((x) => [-2, 2].flatMap((y) => [3, 9].map((z) => [x, y, z])));
  near(restOf(corners.flat(), [0, 0, 1]), [0, 0, 3]);
  near(restOf(corners.flat(), [0, 0, -1]), [0, 0, 9]);
  near(restOf(corners.flat(), [-1, 0, 0]), [1, 0, 6]);
});

test('a box crops on the sides that it has', () => {
  assert.deepEqual(planesOf([null, null, null, null, null, null]), []);
  assert.deepEqual(planesOf([-5, null, 2, null, 7, 40]), [[-1, 0, 0, 5], [0, 0, -1, -2], [0, 1, 0, 7], [0, 0, 1, 40]]);
});

test('a model is edited if anything was cut, erased, laid or scaled', () => {
  assert.ok(isEdited(before) && isEdited({scale: 2}) && isEdited({erase_mm: [[0, 0, 0, 1]]}) && isEdited({lay_mm: before.lay_mm}));
  assert.ok(!isEdited({}) && !isEdited({cut_mm: [], erase_mm: [], lay_mm: null, scale: 1, max_triangles: 500}));
});
