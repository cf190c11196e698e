import assert from 'node:assert/strict';
import {test} from 'node:test';

import {lightOf, ofLamp, toLamp} from '../../web/model/light.js';

const side = 40;
const ball = {center: [0, 0, 20], radius: 60};

/** A level square of small triangles, `size` wide, around the axis. @returns {number[]} */
function plate(size, height) {
  const step = 1;
  const corners = [];
  for (let x = -size / 2; x < size / 2; x += step) {
    for (let y = -size / 2; y < size / 2; y += step) {
      corners.push(x, y, height, x + step, y, height, x, y + step, height);
    }
  }
  return corners;
}

/** The light on corners within 5 mm of a place. @returns {number[]} means of room and lamp, 0 to 1 */
function lightAt(positions, light, [x, y, z]) {
  const near = Array.from({length: positions.length / 3}, (_, corner) => corner).filter((corner) =>
    Math.hypot(positions[3 * corner] - x, positions[3 * corner + 1] - y, positions[3 * corner + 2] - z) < 5);
  assert.ok(near.length > 20);
  return [0, 1].map((channel) => near.reduce((sum, corner) => sum + light[2 * corner + channel], 0) / near.length / 255);
}

/** @param {number[]} corners  of triangles that all face upwards */
function lightOn(corners) {
  const positions = Float32Array.from(corners);
  const normals = Int16Array.from(corners, (_, i) => i % 3 === 2 ? 32767 : 0);
  return [positions, lightOf(positions, normals, ball)];
}

test('a plate with nothing above it has all the light', () => {
  const [positions, light] = lightOn(plate(side, 0));
  assert.ok(light.every((share) => share > 250), 'a plain surface is not in its own way, at any angle');
  assert.equal(light.length, 2 * positions.length / 3);
});

test('below a roof there is less of the room’s light, and none of the lamp’s where its shadow falls', () => {
  const height = 25;
  const [positions, light] = lightOn([...plate(80, 0), ...plate(side, height)]);
  const shadow = toLamp.map((value) => -height * value / toLamp[2]);
  const [room, lamp] = lightAt(positions, light, [shadow[0], shadow[1], 0]);
  assert.ok(room < 0.85, `${room} of the room’s`);
  assert.ok(lamp < 0.1, `${lamp} of the lamp’s`);
  const [beneath] = lightAt(positions, light, [0, 0, 0]);
  assert.ok(beneath < 0.65, `${beneath} in the middle, which the roof covers most`);
  assert.deepEqual(lightAt(positions, light, [0, 0, height]).map(Math.round), [1, 1]);
});

test('the lamp is a disc: its points are a little apart, around its middle', () => {
  const cosines = ofLamp(24).map((d) => d.reduce((sum, value, axis) => sum + value * toLamp[axis], 0));
  assert.ok(cosines.every((cosine) => cosine > Math.cos(0.11) && cosine <= 1));
  assert.ok(Math.min(...cosines) < Math.cos(0.09));
});
