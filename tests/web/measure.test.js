import assert from 'node:assert/strict';
import {test} from 'node:test';

import {
  angleOf, circleOf, measureDrawing, measureText, sectionText, sizeDrawing, sizeText, withPoint,
} from '../../web/model/measure.js';

const near = (actual, expected, off = 1e-9) =>
  assert.ok(Math.abs(actual - expected) <= off, `${actual} and not ${expected}`);
const pickAll = (kind, points) => points.reduce((picked, point) => withPoint(kind, picked, point), []);

/** A point of a circle about a center, in a plane that leans. */
function onCircle([x, y, z], radius, angle) {
  const [c, s] = [radius * Math.cos(angle), radius * Math.sin(angle)];
  return [x + 0.6 * c, y + s, z + 0.8 * c];
}

test('two places are measured between, and a third one begins anew', () => {
  const [a, b, c] = [[0, 0, 0], [3, -4, 12], [1, 1, 1]];
  const pair = pickAll('distance', [a, b]);
  assert.deepEqual(pair, [a, b]);
  assert.equal(measureText('distance', pair), '13.0 mm (ΔX 3.0, ΔY 4.0, ΔZ 12.0)');
  assert.deepEqual(withPoint('distance', pair, c), [c]);
  assert.notEqual(measureText('distance', []), measureText('distance', [a]));
  assert.deepEqual(measureDrawing('distance', pair), {points: pair, lines: [pair], labels: [{at: [1.5, -2, 6], words: '13.0 mm'}]});
});

test('three points of a rim give its diameter, in every plane, even close together', () => {
  const center = [12, -30, 44];
  for (const angles of [[0, 2, 4], [0.1, 0.3, 0.5], [3, 1, 5.5]]) {
    const rim = angles.map((angle) => onCircle(center, 21.2, angle));
    const circle = circleOf(rim);
    near(circle.radius, 21.2, 1e-6);
    circle.center.forEach((value, axis) => near(value, center[axis], 1e-6));
    assert.equal(measureText('diameter', pickAll('diameter', rim)), '⌀ 42.4 mm');
    const {lines: [drawn], labels} = measureDrawing('diameter', rim);
    drawn.forEach((point) => near(Math.hypot(...point.map((value, axis) => value - center[axis])), 21.2, 1e-6));
    const [x, y, z] = drawn[17].map((value, axis) => value - center[axis]);
    near(0.8 * x - 0.6 * z, 0, 1e-6);
    assert.ok(Number.isFinite(y));
    assert.equal(labels[0].words, '⌀ 42.4 mm');
  }
});

test('points on a line, or twice the same, give no diameter, and are told', () => {
  for (const points of [[[0, 0, 0], [1, 2, 3], [2, 4, 6]], [[1, 1, 1], [1, 1, 1], [4, 0, 0]]]) {
    assert.equal(circleOf(points), null);
    assert.equal(measureText('diameter', points), 'These points lie on a line.');
    assert.deepEqual(measureDrawing('diameter', points), {points});
  }
});

test('an angle is that of its second point', () => {
  for (const [b, degrees] of [[[0, 5, 0], 90], [[7, 7, 0], 45], [[-3, 0, 0], 180], [[-1, Math.sqrt(3), 0], 120]]) {
    near(angleOf([[4, 0, 0], [0, 0, 0], b]), degrees, 1e-6);
  }
  const points = pickAll('angle', [[10, 0, 3], [0, 0, 3], [0, 0, 8]]);
  assert.equal(measureText('angle', points), '90.0°');
  assert.equal(new Set([0, 1, 2].map((count) => measureText('angle', points.slice(0, count)))).size, 3);
  assert.deepEqual(measureDrawing('angle', points).labels, [{at: [0, 0, 3], words: '90.0°'}]);
});

test('dimension lines are as long as the sides of the box, beside it', () => {
  const box = {min: [-20, -5, 0], max: [30, 15, 80]};
  assert.match(sizeText(box), /50\.0 × 20\.0 × 80\.0 mm$/);
  const {lines, labels} = sizeDrawing(box);
  const long = lines.filter((_, index) => index % 3 === 0);
  assert.deepEqual(labels.map(({words}) => words), ['50.0 mm', '20.0 mm', '80.0 mm']);
  [50, 20, 80].forEach((length, axis) => near(Math.hypot(...long[axis][0].map((value, i) => value - long[axis][1][i])), length));
  const isBeside = ([x, y]) => x < -20 || x > 30 || y < -5 || y > 15;
  assert.ok(long.flat().every(isBeside), `${long}`);
});

test('a section tells its width, height and area', () => {
  assert.equal(sectionText({width: 40, height: 12.34, area: 493.62}), 'Section: 40.0 × 12.3 mm, 493.6 mm²');
  assert.equal(sectionText({width: 40, height: 12.34, area: null}), 'Section: 40.0 × 12.3 mm, open');
  assert.equal(sectionText(null), 'The cut misses the model.');
});
