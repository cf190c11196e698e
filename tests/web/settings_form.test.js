import assert from 'node:assert/strict';
import {test} from 'node:test';

import {
  areEqual, asShown, changeOf, complaintOf, helpOf, joined, keyOf, nameOf, poseText, reasonOf, restartText, schemaAt,
  stepsOf, valueAt, valueText, wordsOf,
} from '../../web/scanner/settings_form.js';

test('a setting is found, and a change of it made, by its key', () => {
  assert.equal(valueAt({turntable: {gear_ratio: 4}}, 'turntable.gear_ratio'), 4);
  assert.equal(valueAt({}, 'turntable.gear_ratio'), undefined);
  assert.deepEqual(changeOf('turntable.gear_ratio', null), {turntable: {gear_ratio: null}});
  assert.deepEqual(changeOf('port', 80), {port: 80});
  const schema = {properties: {turntable: {properties: {reversed: {type: 'boolean', description: ''}}}}};
  assert.equal(schemaAt(schema, 'turntable.reversed').type, 'boolean');
});

test('changes of several settings are one', () => {
  const changes = [changeOf('scan.frames', 7), changeOf('port', 80), changeOf('scan.clip_mm', [1, 2])];
  assert.deepEqual(changes.reduce(joined, {}), {scan: {frames: 7, clip_mm: [1, 2]}, port: 80});
});

test('a value that the scanner would refuse is refused before', () => {
  const whole = {type: 'integer', description: '', minimum: 1, maximum: 200};
  assert.equal(complaintOf(whole, 36), '');
  assert.match(complaintOf(whole, 201), /between 1 and 200/);
  assert.match(complaintOf(whole, 1.5), /whole number/);
  assert.match(complaintOf({...whole, type: 'number'}, null), /A number/);
  assert.equal(complaintOf({...whole, type: 'number'}, 1.5), '');
  const box = {type: 'array', description: '', minItems: 6};
  assert.equal(complaintOf(box, [-1, -1, 0, 1, 1, 2]), '');
  assert.match(complaintOf(box, [-1, -1, 2, 1, 1, 2]), /end beyond/);
  assert.match(complaintOf(box, [NaN, -1, 0, 1, 1, 2]), /Six numbers/);
  assert.equal(complaintOf({type: 'string', description: ''}, ''), '');
});

test('a problem is told beside the setting that it is about', () => {
  const outOfRange = {detail: '“turntable.gear_ratio” must be from 0.001 to 1000.', parameters: {key: 'turntable.gear_ratio', minimum: 0.001, maximum: 1000}};
  assert.equal(keyOf(outOfRange), 'turntable.gear_ratio');
  assert.equal(reasonOf(outOfRange), 'It must be between 0.001 and 1000.');
  assert.equal(keyOf({detail: '"scan.method" is 3: must be text'}), 'scan.method');
  assert.equal(reasonOf({detail: '"scan.method" is 3: must be text'}), 'It must be text.');
  assert.equal(keyOf({detail: 'the disk is full'}), null);
  assert.equal(reasonOf({detail: '"ports": unknown key'}), '"ports": unknown key');
});

test('values are told in words', () => {
  assert.equal(valueText(false), 'off');
  assert.equal(valueText('average-discard'), 'Average, discard');
  assert.equal(valueText([]), 'none');
  assert.deepEqual(wordsOf(' GPIO22, GPIO23  GPIO24,'), ['GPIO22', 'GPIO23', 'GPIO24']);
  assert.ok(areEqual([1, 2], [1, 2]) && !areEqual([1, 2], [2, 1]));
  assert.equal(nameOf('turntable.gear_ratio'), 'Gear ratio');
});

test('help is a sentence for people', () => {
  assert.equal(helpOf('new', {type: 'integer', description: 'threads of `octurn`'}), 'Threads of octurn.');
  assert.match(helpOf('turntable.reversed', {type: 'boolean', description: '`true` if'}), /^On if/);
});

test('a pose is told as distance, height and tilt', () => {
  const [sine, cosine] = [Math.sin(Math.PI / 6), Math.cos(Math.PI / 6)];
  // 0.6 m in front of the axis and 0.3 m up, looking along Y, pitched down by 30 degrees.
  const pose = [[1, 0, 0, 0], [0, -sine, cosine, -0.6], [0, -cosine, -sine, 0.3], [0, 0, 0, 1]];
  assert.equal(poseText(pose), '600 mm from the platform’s axis, 300 mm above its surface, looking 30.0° down.');
});

test('a turn has the steps of motor, driver and gear', () => {
  assert.equal(stepsOf({full_steps: 200, microsteps: 4, gear_ratio: 60 / 17}), 2824);
});

test('what waits for a restart says for how long', () => {
  assert.equal(restartText([], false), '');
  assert.match(restartText(['port'], false), /restarts/);
  assert.match(restartText(['port'], true), /when the scan has ended/);
});

test('a square of a length is shown as the length', () => {
  const square = {type: 'number', description: '', 'x-unit': 'm2', minimum: 1e-8, maximum: 1};
  const {schema, toShown, toStored} = asShown(square);
  assert.deepEqual([schema['x-unit'], schema.minimum, schema.maximum], ['mm', 0.1, 1000]);
  assert.equal(toShown(0.0001), 10);
  assert.equal(toStored(20), 0.0004);
  const whole = {type: 'integer', description: '', minimum: 1, maximum: 200};
  assert.equal(asShown(whole).schema, whole);
  assert.equal(asShown(whole).toStored(36), 36);
});
