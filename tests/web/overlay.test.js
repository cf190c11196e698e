import assert from 'node:assert/strict';
import {test} from 'node:test';

import {overlayOf, pixelOf} from '../../web/sensor/overlay.js';
import {poseOf, toSensor} from '../../web/base/pose.js';

const sensor = {width: 640, height: 480, fx: 576, fy: 576, cx: 320, cy: 240};
const clip_mm = [-140, -140, 5, 140, 140, 400];
const pose = poseOf({x_mm: 0, y_mm: -620, z_mm: 360, tilt_deg: 25, roll_deg: 0, yaw_deg: 0});
const overlay = (changes = {}) => overlayOf({pose, sensor, clip_mm, radius_mm: 150, ...changes});
const numbers = (path) => path.match(/-?\d+(\.\d+)?/g).map(Number);

test('the middle of the platform is where the sensor looks', () => {
  // The optical axis, 25 degrees down from 0.36 m, meets the platform 0.36 / tan 25 = 0.772 m ahead, beyond the turntable's axis. So the
  // platform's centre appears below the picture's centre.
  const [x, y] = pixelOf(sensor, toSensor(pose, [0, 0, 0]));
  const angle = Math.atan2(0.36, 0.62) - 25 * Math.PI / 180;
  assert.ok(Math.abs(x - 320) < 1e-9);
  assert.ok(Math.abs(y - (240 + 576 * Math.tan(angle))) < 1e-9);
});

test('the axis rises straight, and the ring is even to both sides', () => {
  const [x0, y0, x1, y1] = numbers(overlay().axis);
  assert.deepEqual([x0, x1], [320, 320]);
  assert.ok(y1 < y0);
  const across = numbers(overlay().ring).filter((_, index) => index % 2 === 0);
  assert.ok(Math.abs(Math.min(...across) + Math.max(...across) - 640) < 0.2, 'rounded to tenths');
});

test('the box has twelve edges', () => {
  assert.equal(overlay().box.match(/M/g).length, 12);
});

test('what is behind the sensor is not drawn, and what passes it ends there', () => {
  assert.equal(overlay({clip_mm: [-100, -900, 0, 100, -800, 100]}).box, '');
  const passing = overlay({clip_mm: [-100, -900, 0, 100, 100, 100]}).box;
  assert.ok(passing.match(/M/g).length < 12 && numbers(passing).every(Number.isFinite));
});
