import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';
import {inflateRawSync} from 'node:zlib';

import {hasFirstModel, stepsOf} from '../../web/scanner/checklist.js';
import {finished, running} from './examples.js';

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

/** The first file of an archive, which is its job.json. @returns {Promise<any>} */
async function demoScan() {
  const zip = await readFile(new URL('../../web/demo.zip', import.meta.url));
  const [packed, nameLength, extraLength] = [zip.readUInt32LE(18), zip.readUInt16LE(26), zip.readUInt16LE(28)];
  const begin = 30 + nameLength + extraLength;
  assert.equal(zip.toString('utf8', 30, 30 + nameLength), 'job.json');
  return JSON.parse(inflateRawSync(zip.subarray(begin, begin + packed)).toString());
}

test('the demo that somebody opened is nobody’s first model', async () => {
  const demo = {...finished, created: (await demoScan()).created};
  assert.ok(!hasFirstModel([demo, running]));
  assert.ok(hasFirstModel([demo, finished]));
  assert.ok(!hasFirstModel([]));
});
