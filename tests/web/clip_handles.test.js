import assert from 'node:assert/strict';
import {test} from 'node:test';

import {draggedTo, handlesOf} from '../../web/sensor/clip_handles.js';
import {pixelOf} from '../../web/sensor/overlay.js';
import {poseOf, toSensor} from '../../web/base/pose.js';

const pose = poseOf({x_mm: 12, y_mm: -620, z_mm: 360, tilt_deg: 25, roll_deg: 2, yaw_deg: 3});
const sensor = {width: 640, height: 480, fx: 575.8, fy: 575.8, cx: 320, cy: 240};
const clip_mm = [-140, -140, 5, 140, 140, 200];
const rig = {pose, sensor, clip_mm};

test('every side that is in the picture has a handle, which lies on it and in the picture', () => {
  const handles = handlesOf(rig);
  assert.deepEqual(handles.map(({index}) => index), [0, 1, 2, 3, 4, 5]);
  for (const {index, x, y, at_mm} of handles) {
    assert.equal(at_mm[index % 3], clip_mm[index]);
    assert.ok(x > 0 && x < 640 && y > 0 && y < 480);
  }
});

test('a side that the sensor does not see has none', () => {
  const sides = handlesOf({...rig, clip_mm: [-140, -140, 5, 140, 140, 900]}).map(({index}) => index);
  assert.ok(!sides.includes(5) && sides.includes(2));
});

test('a handle goes to the place along its axis that the pointer shows', () => {
  for (const handle of handlesOf(rig)) {
    const axis = handle.index % 3;
    const wanted = handle.at_mm.map((value, one) => value + (one === axis ? 30 : 0));
    const [x, y] = pixelOf(sensor, toSensor(pose, wanted.map((value) => value / 1000)));
    assert.ok(Math.abs(draggedTo(rig, handle, x, y) - wanted[axis]) < 1e-6, `side ${handle.index}`);
    assert.ok(Math.abs(draggedTo(rig, handle, handle.x, handle.y) - clip_mm[handle.index]) < 1e-6);
  }
});

test('where the view goes along an axis a pixel says nothing of it', () => {
  const level = poseOf({x_mm: 0, y_mm: -620, z_mm: 0, tilt_deg: 0, roll_deg: 0, yaw_deg: 0});
  assert.equal(draggedTo({pose: level, sensor}, {index: 4, x: 320, y: 240, at_mm: [0, 140, 0]}, 320, 240), null);
});
