// The lasers of the twin, alone.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {LaserLines} from './laser_lines.mjs';

const [step, enable, left, right] = [17, 5, 23, 24];

test('a laser is lit while its line is high, and counted when it is switched on', () => {
  const lasers = new LaserLines();
  assert.equal(lasers.lit, 'none');
  lasers.change(left, 1);
  lasers.change(left, 1);
  assert.equal(lasers.lit, 'left');
  lasers.change(left, 0);
  lasers.change(right, 1);
  assert.equal(lasers.lit, 'right');
  lasers.losePower();
  assert.equal(lasers.lit, 'none');
  assert.deepEqual(lasers.lights, {left: 1, right: 1});
  assert.deepEqual(lasers.faults, []);
});

test('a step with a laser that is lit is a fault, and so are two lasers', () => {
  const lasers = new LaserLines();
  lasers.change(step, 1);
  lasers.change(step, 0);
  lasers.change(enable, 1);
  assert.deepEqual(lasers.faults, []);
  lasers.change(left, 1);
  lasers.change(step, 1);
  lasers.change(step, 0);
  assert.match(lasers.faults[0], /a step while the left laser was lit/);
  lasers.change(right, 1);
  assert.match(lasers.faults[1], /both/);
  assert.equal(lasers.faults.length, 2);
});
