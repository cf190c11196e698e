import assert from 'node:assert/strict';
import {test} from 'node:test';

import {restingSide} from '../../web/model/resting_pose.js';
import {Vector3} from '../../web/three.js';

/** A number in [-1, 1) that is always the same for i, and has nothing to do with that for i + 1. */
const noise = (i) => 2 * (Math.abs(Math.sin(12.9898 * i) * 43758.5453) % 1) - 1;

/** Points of a box of 40 x 60 x 100 mm around the origin, two millimetres apart, each moved as far as noise does. */
function roughBox({amplitude, dent = 0}) {
  const half = [20, 30, 50];
  const points = [];
  for (let axis = 0; axis < 3; ++axis) {
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const side of [-1, 1]) {
      for (let a = -half[u]; a <= half[u]; a += 2) {
        for (let b = -half[v]; b <= half[v]; b += 2) {
          const point = [0, 0, 0];
          const isDented = axis === 0 && side === 1 && Math.hypot(a, b) < 12;
          point[axis] = side * half[axis] + amplitude * noise(points.length) - (isDented ? dent : 0);
          point[u] = a;
          point[v] = b;
          points.push(new Vector3(...point));
        }
      }
    }
  }
  return points;
}

const degreesBetween = (a, b) => a.angleTo(b) * 180 / Math.PI;

test('a box rests on the side that has the place', () => {
  const box = roughBox({amplitude: 0});
  for (const [place, side] of [[[20, 12, 31], [1, 0, 0]], [[-20, -22, 3], [-1, 0, 0]], [[5, 30, 20], [0, 1, 0]], [[4, -9, -50], [0, 0, -1]]]) {
    assert.ok(degreesBetween(restingSide(box, new Vector3(...place)), new Vector3(...side)) < 0.1, `${place}`);
  }
});

test('a rough box rests on its side, although its facets point all ways', () => {
  const box = roughBox({amplitude: 0.5});
  for (const [place, side] of [[[20, 4, 11], [1, 0, 0]], [[3, -30, -13], [0, -1, 0]], [[2, 5, 50], [0, 0, 1]]]) {
    assert.ok(degreesBetween(restingSide(box, new Vector3(...place)), new Vector3(...side)) < 2, `${place}`);
  }
});

test('an object rests over a dent, not in it', () => {
  const box = roughBox({amplitude: 0.5, dent: 9});
  assert.ok(degreesBetween(restingSide(box, new Vector3(11, 2, 3)), new Vector3(1, 0, 0)) < 2);
});

test('a box tips over from a bevel to the side beside it that is lower', () => {
  const outline = [[-20, -30], [20, -30], [20, 26], [16, 30], [-20, 30]];
  const box = outline.flatMap(([x, y]) => [-50, 50].map((z) => new Vector3(x, y, z)));
  assert.ok(degreesBetween(restingSide(box, new Vector3(18, 28, 5)), new Vector3(1, 0, 0)) < 0.1);
});

test('it rests on three points that all others and its center of mass are above', () => {
  const box = roughBox({amplitude: 3});
  const center = box.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(box.length);
  for (let i = 0; i < 50; ++i) {
    const normal = restingSide(box, new Vector3(20 * noise(3 * i), 30 * noise(3 * i + 1), 50 * noise(3 * i + 2)));
    const byDepth = [...box].sort((a, b) => b.dot(normal) - a.dot(normal));
    const depths = byDepth.map((point) => point.dot(normal));
    assert.ok(depths[0] - depths[2] < 1e-3, `it rests on three points, not on ${depths.slice(0, 3)}`);
    const corners = byDepth.slice(0, 3);
    const isLeft = corners.map((corner, k) =>
      corners[(k + 1) % 3].clone().sub(corner).cross(center.clone().sub(corner)).dot(normal) > 0);
    assert.equal(new Set(isLeft).size, 1, `the center is beside ${corners.map((corner) => corner.toArray())}`);
  }
});
