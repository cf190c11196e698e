import assert from 'node:assert/strict';
import {test} from 'node:test';

import {cureText, shownOf} from '../../web/scanner/turntable.js';

const finding = (state, set = {}) => ({check: 'turn-whole', name: 'A whole turn', state, measured: '', advice: '', set});
const tested = (findings) => ({state: 'idle', error: null, test: {state: 'done', done: 1, findings, error: null}});

test('a turntable at rest is not moving', () => {
  assert.deepEqual(shownOf({state: 'idle', error: null, test: null}), {isMoving: false, progress: null, summary: '', trouble: '', findings: []});
});

test('a test shows how far it is, and nothing of the test before', () => {
  const shown = shownOf({state: 'testing', error: null, test: {state: 'running', done: 0.25, findings: [], error: null}});
  assert.equal(shown.progress, 0.25);
  assert.ok(shown.isMoving);
});

test('a test tells its outcome', () => {
  assert.match(shownOf(tested([finding('ok')])).summary, /turns as configured/);
  assert.match(shownOf(tested([finding('ok'), finding('warning')])).summary, /does not/);
  assert.equal(shownOf(tested([finding('fault')])).findings.length, 1);
});

test('why a test or a jog failed is told while it stands', () => {
  const failure = {code: 'sensor-blind', detail: 'there is no object', hint: 'Put one there.'};
  const failed = {state: 'failed', done: 0.1, findings: [], error: failure};
  assert.equal(shownOf({state: 'idle', error: null, test: failed}).trouble, 'There is no object. Put one there.');
  assert.equal(shownOf({state: 'jogging', error: null, test: failed}).trouble, '');
});

test('a cure is a button in the words of the setting', () => {
  assert.equal(cureText({gear_ratio: 1.333}), 'Set Gear ratio to 1.333');
  assert.equal(cureText({reversed: true}), 'Set Turn the other way to on');
  assert.equal(cureText({}), '');
});
