import assert from 'node:assert/strict';
import {test} from 'node:test';

import * as format from '../../web/base/format.js';

test('bytes have three figures at most', () => {
  assert.deepEqual([0, 999, 1000, 9949, 9950, 999499, 50551684, 12.3e9].map(format.bytes),
      ['0 byte', '999 byte', '1.0 kB', '9.9 kB', '10 kB', '999 kB', '51 MB', '12 GB']);
});

test('durations go from hundredths to hours', () => {
  assert.deepEqual([0.08, 4.66, 59.4, 59.6, 3599, 7260].map(format.duration),
      ['0.08 s', '4.7 s', '59 s', '1 min 0 s', '59 min 59 s', '2 h 1 min']);
});

test('the time left never claims more than it knows', () => {
  assert.deepEqual([null, 0.4, 12, 40.1, 55, 100, 3600].map(format.timeLeft),
      ['', 'a moment left', 'about 15 s left', 'about 45 s left', 'about 1 min left', 'about 2 min left', 'about 60 min left']);
});

test('a scan that takes longer than expected is not said to end in a moment', () => {
  assert.equal(format.timeLeft(0), '');
});

test('a message becomes a sentence, and nothing stays nothing', () => {
  assert.deepEqual(['no frame', 'Is it on?', ''].map(format.sentence), ['No frame.', 'Is it on?', '']);
});
