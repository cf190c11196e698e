import assert from 'node:assert/strict';
import {test} from 'node:test';

import {hintOf, steadyHint} from '../../web/sensor/live_hints.js';
import {movedShare, seenOf} from '../../web/sensor/live_picture.js';
import {poseOf, toPlatform} from '../../web/base/pose.js';

const sensor = {width: 640, height: 480, fx: 576, fy: 576, cx: 320, cy: 240, nearest_m: 0.5, best_m: [0.6, 0.9], farthest_m: 1.2};
const pose = poseOf({x_mm: 0, y_mm: -620, z_mm: 360, tilt_deg: 25, roll_deg: 0, yaw_deg: 0});
const clip_mm = [-140, -140, 5, 140, 140, 400];
const rig = {pose, sensor, clip_mm};
const [width, height] = [320, 240];

/** The brightness of a depth in the preview, by API.md. */
const brightnessAt = (metres, nearest = 0.5) => metres === 0 ? 0 :
  Math.round(24 + 231 * Math.min(1, Math.max(0, (1 / metres - 1 / 2) / (1 / (0.9 * nearest) - 1 / 2))));

/** The distance along a pixel's ray to a box on the platform; Infinity if it misses. @param {number[]} box metres */
function throughBox(from, along, box) {
  let [near, far] = [-Infinity, Infinity];
  for (let axis = 0; axis < 3; ++axis) {
    const [a, b] = [box[axis], box[axis + 3]].map((side) => (side - from[axis]) / along[axis]).sort((x, y) => x - y);
    [near, far] = [Math.max(near, a), Math.min(far, b)];
  }
  return near < far ? near : Infinity;
}

/** The preview of a box on a large platform. @param {number[]} box  millimetres */
function pictureOf(box, eye = pose, nearest = 0.5) {
  const from = toPlatform(eye, [0, 0, 0]);
  return Uint8Array.from({length: width * height}, (_, index) => {
    const ray = [(2 * (index % width) - 320) / 576, (2 * Math.floor(index / width) - 240) / 576, 1];
    const along = toPlatform(eye, ray).map((value, axis) => value - from[axis]);
    const platform = along[2] < 0 ? -from[2] / along[2] : Infinity;
    const depth = Math.min(platform, throughBox(from, along, box.map((value) => value / 1000)));
    return Number.isFinite(depth) ? brightnessAt(depth, nearest) : 0;
  });
}

const cube = [-40, -40, 0, 40, 40, 80];
const hint = (box, changes = {}) => hintOf(seenOf(pictureOf(box), width, {...rig, ...changes}), 0, {...rig, ...changes});

test('an object in the middle is ready, and its size and distance are told', () => {
  const seen = seenOf(pictureOf(cube), width, rig);
  assert.ok(Math.abs(seen.width_mm - 80) < 4 && Math.abs(seen.height_mm - 80) < 4, `${seen.width_mm} ${seen.height_mm}`);
  assert.equal(hint(cube).code, 'good');
  assert.match(hint(cube).detail, /8 cm wide, 8 cm high, 6\d cm away/);
});

test('what lies in the scanned space is marked, and the platform is not', () => {
  const {inside} = seenOf(pictureOf(cube), width, rig);
  const share = inside.reduce((sum, value) => sum + value, 0) / inside.length;
  // 8 cm at 0.66 m are 35 of 320 columns; seen from 28 degrees above, front and top together are 40 to 45 of 240 rows.
  assert.ok(share > 35 * 38 / (width * height) && share < 38 * 47 / (width * height), `${share}`);
});

test('an empty platform asks for an object', () => assert.equal(hint([0, 0, -20, 1, 1, -10]).code, 'empty'));

test('a picture without readings says so', () =>
  assert.equal(hintOf(seenOf(new Uint8Array(width * height), width, rig), 0, rig).code, 'blind'));

test('a space that ends in the object cuts it: at its top, or at its side', () => {
  assert.equal(hint(cube, {clip_mm: [-140, -140, 5, 140, 140, 50]}).code, 'cut-top');
  assert.equal(hint(cube, {clip_mm: [-140, -140, 5, 20, 140, 400]}).code, 'cut-side');
});

test('an object far from the middle is told to turn out of a narrow space', () => {
  assert.equal(hint([-40, 60, 0, 40, 130, 80], {clip_mm: [-100, -140, 5, 100, 140, 400]}).code, 'turns-out');
  assert.equal(hint([-40, 60, 0, 40, 130, 80]).code, 'good');
});

test('an object before the place from which the sensor sees is too near, one behind it too far', () => {
  const at = (away) => poseOf({x_mm: 0, y_mm: -away, z_mm: 0.58 * away, tilt_deg: 28, roll_deg: 0, yaw_deg: 0});
  const code = (away) => hintOf(seenOf(pictureOf(cube, at(away)), width, {...rig, pose: at(away)}), 0, rig).code;
  assert.equal(code(440), 'too-near');
  assert.equal(code(620), 'good');
  assert.equal(code(1250), 'too-far');
});

test('a sensor that sees from 7 cm on has hints of its own range', () => {
  const nearSensor = {...sensor, nearest_m: 0.07, best_m: [0.1, 0.3], farthest_m: 0.5};
  const hintAt = (away) => {
    const eye = poseOf({x_mm: 0, y_mm: -away, z_mm: 0.58 * away, tilt_deg: 28, roll_deg: 0, yaw_deg: 0});
    const near = {...rig, sensor: nearSensor, pose: eye};
    return hintOf(seenOf(pictureOf([-15, -15, 0, 15, 15, 30], eye, 0.07), width, near), 0, near);
  };
  assert.equal(hintAt(200).code, 'good');
  assert.match(hintAt(200).detail, /2[0-4]\scm away/);
  assert.equal(hintAt(70).code, 'too-near');
  assert.match(hintAt(70).detail, /at least 7\scm/);
  assert.equal(hintAt(500).code, 'too-far');
  assert.match(hintAt(500).detail, /at 10\scm to 30\scm/);
});

test('an object of which a third gives no reading may be dark or shiny', () => {
  const picture = pictureOf(cube);
  const {inside} = seenOf(picture, width, rig);
  assert.equal(hintOf(seenOf(picture.map((value, index) => inside[index] && index % 3 === 0 ? 0 : value), width, rig), 0, rig).code, 'unread');
});

test('an object that is pushed moves, one that only trembles at its edges does not', () => {
  const moved = (box) => {
    const [a, b] = [pictureOf(cube), pictureOf(box)];
    return movedShare(b, a, seenOf(b, width, rig), seenOf(a, width, rig));
  };
  assert.equal(hintOf(seenOf(pictureOf(cube), width, rig), moved([20, -40, 0, 100, 40, 80]), rig).code, 'moves');
  assert.ok(moved([-39, -40, 0, 41, 40, 80]) < 0.05);
});

test('a hint is shown once two pictures agree on it', () => {
  const steady = steadyHint();
  const as = (code) => steady({code, tone: 'good', text: code, detail: ''})?.code;
  assert.deepEqual(['a', 'a', 'b', 'a', 'b', 'b'].map(as), [undefined, 'a', 'a', 'a', 'a', 'b']);
});
