import assert from 'node:assert/strict';
import {test} from 'node:test';

import {progressAfter, shownOf} from '../../web/scanner/doctor.js';

const finding = (check, state, more = {}) => ({check, name: check, state, measured: '1 mm', advice: '', action: '', ...more});

test('faults come first, then warnings, what is in order, and what is not known', () => {
  const {lines} = shownOf({findings: [finding('a', 'ok'), finding('b', 'unknown'), finding('c', 'warning'), finding('d', 'fault'), finding('e', 'ok')]});
  assert.deepEqual(lines.map(({key}) => key), ['d', 'c', 'a', 'e', 'b']);
  assert.deepEqual(lines.map(({stateName}) => stateName), ['Fault', 'Warning', 'OK', 'OK', 'Not known']);
});

test('the summary counts faults and warnings', () => {
  const summary = (...states) => shownOf({findings: states.map((state, index) => finding(String(index), state))}).summary;
  assert.equal(summary('fault', 'ok', 'fault', 'warning'), '2 faults and 1 warning found.');
  assert.equal(summary('warning', 'warning'), '2 warnings found.');
  assert.equal(summary('ok', 'unknown'), 'Everything that could be checked is in order.');
});

test('what was measured and what to do are sentences', () => {
  const {lines: [line]} = shownOf({findings: [finding('usb', 'fault', {measured: 'no sensor', advice: 'plug it in'})]});
  assert.equal(line.measured, 'No sensor');
  assert.equal(line.advice, 'Plug it in.');
});

test('a finding that the page can do something about has a button that says what', () => {
  const {lines} = shownOf({findings: [finding('platform', 'warning', {action: 'measure-turn'}), finding('usb', 'fault'), finding('disk', 'ok')]});
  assert.deepEqual(lines.map(({key, action, actionName}) => [key, action, actionName]),
    [['usb', '', ''], ['platform', 'measure-turn', 'Measure with a turn'], ['disk', '', '']]);
});

test('the bar grows and never shows the end before it is there', () => {
  assert.equal(progressAfter(0), 0);
  assert.ok(progressAfter(2) > progressAfter(1));
  assert.ok(progressAfter(15) < 1);
});
