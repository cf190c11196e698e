import assert from 'node:assert/strict';
import {test} from 'node:test';

import {cursorOf, edgesAt, withSide} from '../../web/sensor/clip_edges.js';
import {fromAbove, fromSide, planOf} from '../../web/sensor/plans.js';

const clip_mm = [-140, -140, 5, 140, 140, 400];
const plan = planOf(fromSide, clip_mm, 150, 400, 260);
const at = (right, up, offset = [0, 0]) => {
  const [x, y] = plan.toPixel(right, up);
  return edgesAt(plan, fromSide, clip_mm, x + offset[0], y + offset[1], 7);
};

test('a pointer takes hold of the side that it is on, or of both at a corner', () => {
  assert.deepEqual(at(-140, 200), [1]);
  assert.deepEqual(at(140, 200, [5, 0]), [4]);
  assert.deepEqual(at(0, 400), [5]);
  assert.deepEqual(at(140, 5), [4, 2]);
});

test('elsewhere it takes hold of nothing', () => {
  assert.deepEqual(at(0, 200), []);
  assert.deepEqual(at(140, 200, [9, 0]), []);
  assert.deepEqual(at(-140, 400, [0, -30]), []);
});

test('from above, the sides to the right and away are dragged', () => {
  const above = planOf(fromAbove, clip_mm, 150, 400, 260);
  assert.deepEqual(edgesAt(above, fromAbove, clip_mm, ...above.toPixel(140, 0), 7), [3]);
  assert.deepEqual(edgesAt(above, fromAbove, clip_mm, ...above.toPixel(0, -140), 7), [1]);
});

test('a side moves to the millimetre, and never through the other', () => {
  assert.deepEqual(withSide(clip_mm, 5, 212.4), [-140, -140, 5, 140, 140, 212]);
  assert.deepEqual(withSide(clip_mm, 5, -50), [-140, -140, 5, 140, 140, 15]);
  assert.deepEqual(withSide(clip_mm, 0, 500), [130, -140, 5, 140, 140, 400]);
});

test('the pointer shows where a side can go', () => {
  assert.deepEqual([[1], [5], [1, 5], [4, 5], []].map((edges) => cursorOf(edges, fromSide)),
      ['ew-resize', 'ns-resize', 'nwse-resize', 'nesw-resize', '']);
});
