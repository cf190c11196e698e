import assert from 'node:assert/strict';
import {test} from 'node:test';

import {restingSide} from '../../web/resting_pose.js';
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

test('every point is on the inner side of what it rests on', () => {
  const box = roughBox({amplitude: 3});
  for (let i = 0; i < 50; ++i) {
    const normal = restingSide(box, new Vector3(20 * noise(3 * i), 30 * noise(3 * i + 1), 50 * noise(3 * i + 2)));
    const heights = box.map((point) => point.dot(normal)).sort((a, b) => b - a);
    assert.ok(heights[0] - heights[2] < 1e-3, `it rests on three points, not on ${heights.slice(0, 3)}`);
  }
});
