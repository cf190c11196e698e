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

test('a reason with its values is worded by the page, one without them as the scanner says it', () => {
  const detailOf = (reason) => verdictOf(judged('look', [{detail: 'as it is said', hint: '', ...reason}])).reasons[0].detail;
  assert.equal(detailOf({code: 'floats', parameters: {platform_above_mm: 3.14}}), 'The platform is seen 3.1 mm above where it should be, and becomes a part of the model.');
  assert.equal(detailOf({code: 'floats', parameters: {bottom_mm: 9}}), 'The model begins 9.0 mm above the platform.');
  assert.equal(detailOf({code: 'moved', parameters: {stop: 5, empty_share: 0.123}}), 'At stop 5 12% of what was seen is empty space as other stops saw it.');
  assert.equal(detailOf({code: 'cut-by-box', parameters: {side: 'top', object_side: 2}}), 'Side 2: The object reaches through the top of the scanned space.');
  assert.equal(detailOf({code: 'parts-dropped', parameters: {parts: 3, volume_cm3: 1.26}}), '3 parts, 1.3 cm³ in all, were not joined to the model, and were dropped.');
  assert.equal(detailOf({code: 'floats'}), 'As it is said.');
  assert.equal(detailOf({code: 'floats', parameters: {depth_furlong: 1}}), 'As it is said.');
});
