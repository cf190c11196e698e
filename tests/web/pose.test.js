import assert from 'node:assert/strict';
import {test} from 'node:test';

import {differenceOf, placementOf, poseOf, toPlatform, toSensor} from '../../web/base/pose.js';

const drawing = {x_mm: 0, y_mm: -620, z_mm: 360, tilt_deg: 25, roll_deg: 0, yaw_deg: 0};
const crooked = {x_mm: 14, y_mm: -606.5, z_mm: 352, tilt_deg: 26.4, roll_deg: -1.4, yaw_deg: 12};

/** @param {number[]} actual @param {number[]} expected @param {number} [tolerance]  rounding of a few operations on numbers near 1000 */
function near(actual, expected, tolerance = 1e-9) {
  actual.forEach((value, index) => assert.ok(Math.abs(value - expected[index]) < tolerance, `${actual} is not ${expected}`));
}

test('the pose of the drawing is the one that the scanner has built in', () => {
  const [c, s] = [Math.cos(25 * Math.PI / 180), Math.sin(25 * Math.PI / 180)];
  poseOf(drawing).forEach((row, index) => near(row, [[1, 0, 0, 0], [0, -s, c, -0.62], [0, -c, -s, 0.36], [0, 0, 0, 1]][index]));
});

test('a placement becomes a pose and comes back', () => {
  for (const placement of [drawing, crooked, {...crooked, yaw_deg: -170, roll_deg: 179}]) {
    near(Object.values(placementOf(poseOf(placement))), Object.values(placement));
  }
});

test('a pose is a rotation and a position', () => {
  const pose = poseOf(crooked);
  for (const a of [0, 1, 2]) {
    for (const b of [0, 1, 2]) {
      near([pose[a].slice(0, 3).reduce((sum, value, index) => sum + value * pose[b][index], 0)], [a === b ? 1 : 0]);
    }
  }
});

test('each number moves what it names', () => {
  const ahead = (changes) => toPlatform(poseOf({...drawing, ...changes}), [0, 0, 0.1]);
  near(ahead({x_mm: 10}), ahead({}).map((value, axis) => value + [0.01, 0, 0][axis]));
  near(ahead({y_mm: -610}), ahead({}).map((value, axis) => value + [0, 0.01, 0][axis]));
  near(ahead({z_mm: 370}), ahead({}).map((value, axis) => value + [0, 0, 0.01][axis]));
  assert.ok(ahead({tilt_deg: 30})[2] < ahead({})[2], 'a tilt looks down');
  const right = toPlatform(poseOf({...drawing, roll_deg: 5}), [0.1, 0, 0]);
  assert.ok(right[2] < 0.36, 'a roll clockwise lowers what is to the right');
});

test('a turn around the axis of the platform is the yaw and nothing else', () => {
  const pose = poseOf(drawing);
  const [c, s] = [Math.cos(0.3), Math.sin(0.3)];
  const turned = [pose[0].map((value, index) => c * value - s * pose[1][index]), pose[0].map((value, index) => s * value + c * pose[1][index]), pose[2], pose[3]];
  near(Object.values(placementOf(turned)), Object.values({...drawing, yaw_deg: 0.3 * 180 / Math.PI}));
});

test('what the sensor sees goes to the platform and back', () => {
  near(toSensor(poseOf(crooked), toPlatform(poseOf(crooked), [0.1, -0.2, 0.7])), [0.1, -0.2, 0.7]);
});

test('the difference of two poses is how far the axis moves and tilts', () => {
  const moved = differenceOf(poseOf(drawing), poseOf({...drawing, x_mm: 3, y_mm: -616}));
  near([moved.shift_mm, moved.tilt_deg], [5, 0], 1e-6);
  const lifted = differenceOf(poseOf(drawing), poseOf({...drawing, z_mm: 365}));
  near([lifted.shift_mm, lifted.lift_mm, lifted.tilt_deg], [0, 5, 0], 1e-6);
  assert.ok(Math.abs(differenceOf(poseOf(drawing), poseOf({...drawing, tilt_deg: 27})).tilt_deg - 2) < 1e-6);
});
