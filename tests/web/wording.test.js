import assert from 'node:assert/strict';
import {test} from 'node:test';

import {refusalText} from '../../web/base/wording.js';

const worded = (code, parameters) => refusalText({code, detail: 'as it is said', parameters});

test('what was refused is worded with its values', () => {
  assert.equal(worded('memory-limit', {limit_mb: 64, needed_mb: 1300}), '64 MB of memory is too little: at least 1,300 MB are needed.');
  assert.equal(worded('memory-limit', {limit_mb: 64}), 'What was seen does not fit into 64 MB of memory.');
  assert.equal(worded('memory-limit', {triangles: 40000001}), 'The model has 40,000,001 triangles, too many for a format that lists its corners.');
  assert.equal(worded('disk-full', {free_mb: 3, needed_mb: 200, path: '/data'}), 'The disk has 3 MB free, and 200 MB are needed.');
  assert.equal(worded('sensor-other', {begun_with: 'Kinect'}), 'This scan was begun with another sensor: Kinect.');
  assert.equal(worded('sensor-other', {camera: 'Camera', width_px: 640, height_px: 480, told_width_px: 3280, told_height_px: 2464}),
      'Camera: its pictures have 640 × 480 pixels, and the settings say 3,280 × 2,464.');
});

test('a full disk is told without the path of a file', () => {
  assert.equal(worded('disk-full', {path: '/var/lib/octurn/scans/20261125-1/job.json'}), 'The disk is full.');
});

test('what has no values, or others, is told as the scanner says it', () => {
  assert.equal(worded('disk-full', {}), 'as it is said');
  assert.equal(worded('memory-limit', {limit_furlong: 1}), 'as it is said');
});
