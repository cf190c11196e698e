import assert from 'node:assert/strict';
import {test} from 'node:test';

import {actionOf, badgeOf, verdictOf} from '../../web/quality.js';
import {finished} from './examples.js';

const judged = (verdict, reasons = [], changes = {}) => ({...finished.model, quality: {verdict, reasons}, ...changes});

test('a good model is ready to slice only if it is closed', () => {
  assert.match(verdictOf(judged('good')).text, /ready to slice/);
  assert.doesNotMatch(verdictOf(judged('good', [], {watertight: false})).text, /ready/);
});

test('each verdict has its tone, and is never told by colour alone', () => {
  const shown = ['good', 'look', 'bad'].map((verdict) => verdictOf(judged(verdict)));
  assert.deepEqual(shown.map(({tone}) => tone), ['good', 'warn', 'bad']);
  assert.equal(new Set(shown.map(({title}) => title)).size, 3);
  assert.equal(new Set(shown.map(({icon}) => icon)).size, 3);
  assert.equal(new Set(['good', 'look', 'bad'].map((verdict) => badgeOf(judged(verdict)).text)).size, 3);
});

test('a reason leads to its cure', () => {
  const href = (code) => actionOf(code)?.href ?? null;
  assert.deepEqual(['stops-disagree', 'cut-by-box', 'part-missing', 'little-seen', 'something-new', undefined].map(href),
      ['#calibrate', '#calibrate', '#calibrate', '#', null, null]);
});

test('a good model of an uneven sensor leads to the wall, and stays good', () => {
  const findings = [{code: 'no-map', detail: 'the flat platform looks uneven', hint: 'flatten the sensor'}, {code: 'slip', detail: '', hint: ''}];
  const {tone, reasons} = verdictOf(judged('good'), findings);
  assert.equal(tone, 'good');
  assert.deepEqual(reasons.map(({detail, action}) => [detail, action.text]), [['The flat platform looks uneven.', 'Flatten the sensor']]);
});

test('a rig that could be better is told beside a good model', () => {
  const findings = ['wobble', 'focal-length', 'turn-not-whole'].map((code) => ({code, detail: code, hint: 'look'}));
  const {tone, reasons} = verdictOf(judged('good'), findings);
  assert.equal(tone, 'good');
  assert.deepEqual(reasons.map(({detail, action}) => [detail, action]), [['Wobble.', null], ['Focal-length.', null]]);
});
