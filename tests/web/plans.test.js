import assert from 'node:assert/strict';
import {test} from 'node:test';

import {fromAbove, fromSide, isInside, placed, planOf} from '../../web/sensor/plans.js';
import {poseOf} from '../../web/base/pose.js';

const clip_mm = [-140, -140, 5, 140, 140, 400];

test('a plan shows the whole of box and platform, and up is up', () => {
  for (const side of [fromSide, fromAbove]) {
    const {toPixel} = planOf(side, clip_mm, 150, 400, 260);
    for (const right of [-150, 150]) {
      for (const up of side.up === 2 ? [-20, 400] : [-150, 150]) {
        const [x, y] = toPixel(right, up);
        assert.ok(x >= 0 && x <= 400 && y >= 0 && y <= 260, `${right} ${up} is at ${x} ${y}`);
      }
    }
    assert.ok(toPixel(0, 100)[1] < toPixel(0, 0)[1]);
    assert.ok(toPixel(100, 0)[0] > toPixel(0, 0)[0]);
  }
});

test('a pixel goes back to the millimetre that it shows', () => {
  const plan = planOf(fromSide, clip_mm, 150, 400, 260);
  const [right, up] = plan.toMillimetres(...plan.toPixel(37, 215));
  assert.ok(Math.abs(right - 37) < 1e-9 && Math.abs(up - 215) < 1e-9);
});

test('a reading is inside the scanned space or not', () => {
  assert.deepEqual([[0, 0, 100], [0, 0, 4], [141, 0, 100]].map((point) => isInside(clip_mm, point)), [true, false, false]);
});

test('readings are placed on the platform by the pose, in millimetres', () => {
  const pose = poseOf({x_mm: 0, y_mm: -600, z_mm: 300, tilt_deg: 0, roll_deg: 0, yaw_deg: 0});
  const [[x, y, z]] = placed(pose, [[10, 20, 500]]);
  assert.ok(Math.hypot(x - 10, y + 100, z - 280) < 1e-9);
});
