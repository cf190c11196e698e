import assert from 'node:assert/strict';
import {test} from 'node:test';

import {stepsOf} from '../../web/scanner/checklist.js';

const first = {isChecked: false, isCalibrated: false, hasModel: false, isDismissed: false};

test('the first steps come one after another', () => {
  assert.deepEqual(stepsOf(first), {check: 'now', calibrate: 'next', scan: 'next'});
  assert.deepEqual(stepsOf({...first, isChecked: true}), {check: 'done', calibrate: 'now', scan: 'next'});
  assert.deepEqual(stepsOf({...first, isChecked: true, isCalibrated: true}), {check: 'done', calibrate: 'done', scan: 'now'});
});

test('who has scanned without calibrating is led to calibrate', () => {
  assert.deepEqual(stepsOf({...first, hasModel: true}), {check: 'done', calibrate: 'now', scan: 'done'});
});

test('the steps go when they are done, dismissed, or not known', () => {
  assert.equal(stepsOf({...first, isCalibrated: true, hasModel: true}), null);
  assert.equal(stepsOf({...first, isDismissed: true}), null);
  assert.equal(stepsOf({...first, isCalibrated: null}), null);
  assert.equal(stepsOf({...first, hasModel: null}), null);
});
