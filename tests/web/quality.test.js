import assert from 'node:assert/strict';
import {test} from 'node:test';

import {actionOf, badgeOf, verdictOf} from '../../web/scan/quality.js';
import {reasonText} from '../../web/base/wording.js';
import {finished} from './examples.js';

const judged = (verdict, reasons = [], changes = {}) => ({...finished.model, quality: {verdict, reasons}, ...changes});

test('a sensor that warmed up differently is told in minutes, with the way to its map', () => {
  const reason = {code: 'warm-up', detail: '', hint: '', parameters: {scan_min: 1, map_min: 12}};
  assert.match(reasonText(reason), /for 1 minute at this scan, and for 12 minutes when its map was made/);
  assert.equal(actionOf('warm-up')?.href, '#calibrate');
});

test('a good model is ready to slice only if it is closed', () => {
  assert.match(verdictOf(judged('good')).text, /Ready to slice/);
  assert.doesNotMatch(verdictOf(judged('good', [], {watertight: false})).text, /ready/i);
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
      ['#calibrate', '#build-again', '#calibrate', '#', null, null]);
  assert.deepEqual(['turntable', 'too-low', 'alike', 'top-unseen'].map(href), ['#settings', '#build-again', '#calibrate', '#']);
});

test('a shell that is too thick or too large leads to the choice of the method', () => {
  const reasons = [{code: 'swollen', parameters: {swelling_mm: 3.04}}, {code: 'swollen', parameters: {stray_share: 0.03}},
    {code: 'large-file', parameters: {file_mb: 227}}].map((reason) => ({detail: '', hint: 'Build.', ...reason}));
  const shown = verdictOf(judged('look', reasons)).reasons;
  assert.deepEqual(shown.map(({detail}) => detail), ['The surface lies up to 3.0 mm outside of what was seen.',
    '3.0% of the surface lies where other stops saw empty space.', 'The file has 227 MB: few slicers open it.']);
  assert.deepEqual(new Set(shown.map(({action, hint}) => `${action.href} ${action.field} ${hint}`)), new Set(['#build-again build-methods ']));
});

test('what only a build can cure leads to the field of Build again, and the scanner’s hint is not said twice', () => {
  const hint = 'Build the model of all parts.';
  const reasons = ['cut-by-box', 'parts-dropped'].map((code) => ({code, detail: code, hint}));
  const shown = verdictOf(judged('look', reasons)).reasons;
  assert.deepEqual(shown.map((reason) => [reason.action.field, reason.hint]), [['build-clip', ''], ['build-parts', '']]);
});

test('a good model of an uneven sensor leads to the wall, and stays good', () => {
  const findings = [{code: 'no-map', detail: 'the flat platform looks uneven', hint: 'flatten the sensor'}, {code: 'slip', detail: '', hint: ''}];
  const {tone, reasons} = verdictOf(judged('good'), findings);
  assert.equal(tone, 'good');
  assert.deepEqual(reasons.map(({detail, action}) => [detail, action.text]), [['The flat platform looks uneven.', 'Correct the sensor’s unevenness']]);
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
  assert.equal(detailOf({code: 'moved', parameters: {stop: 5, empty_share: 0.123}}), 'At stop 5 12% of what was seen lies where other stops saw empty space.');
  assert.equal(detailOf({code: 'cut-by-box', parameters: {side: 'top', object_side: 2}}), 'Side 2: The object reaches through the top of the scanned space.');
  assert.equal(detailOf({code: 'parts-dropped', parameters: {parts: 3, volume_cm3: 1.26}}), '3 parts, 1.3 cm³ in all, were not joined to the model, and were dropped.');
  assert.equal(detailOf({code: 'parts-dropped', parameters: {parts: 1, volume_cm3: 1.26}}), '1 part, 1.3 cm³, was not joined to the model, and was dropped.');
  assert.equal(detailOf({code: 'floats'}), 'As it is said.');
  assert.equal(detailOf({code: 'floats', parameters: {depth_furlong: 1}}), 'As it is said.');
});

test('what a calibration found is worded with its values, also where the verdict has it under its own code', () => {
  const detailOf = (code, parameters) => verdictOf(judged('look', [{code, detail: 'as it is said', hint: '', parameters}])).reasons[0].detail;
  assert.equal(detailOf('moved', {from_stop: 6, to_stop: 7, shift_mm: 3.56}), 'Between stops 6 and 7 the object moved by 3.6 mm.');
  assert.equal(detailOf('moved', {from_stop: 6, to_stop: 7, tilt_deg: 0.31, sink_mm: 0.8}),
      'Between stops 6 and 7 the sensor moved: the platform tilts by 0.3° and sinks by 0.8 mm as it sees it.');
  assert.equal(detailOf('moved', {min_shift_mm: 20, turn_deg: 12}), 'One more look at the first stop: the object moved by more than 20.0 mm and turned by 12.0°.');
  assert.equal(detailOf('stops-disagree', {stop: 5, off_deg: 1.83}), 'At stop 5 the platform stood 1.8° from where it should.');
  assert.equal(detailOf('stops-disagree', {stops: 8}), 'Each of 8 stops shows what the first one shows: the platform did not turn.');
  assert.equal(detailOf('turntable', {stop: 5, off_deg: 1.83}), 'At stop 5 the platform stood 1.8° from where it should.');
  assert.equal(detailOf('turntable', {stops: 8}), 'Each of 8 stops shows what the first one shows: the platform did not turn.');
  for (const code of ['turntable', 'turn-ratio']) {
    assert.equal(detailOf(code, {told_deg: 90, clockwise_deg: 90}), 'Where the platform should turn by 90.0° counter-clockwise, it turned clockwise by 90.0°.');
    assert.equal(detailOf(code, {told_deg: 90, turned_deg: 45}), 'Where the platform should turn by 90.0°, it turned by 45.0°.');
  }
  assert.equal(detailOf('stops-disagree', {turn_deg: 270, object_side: 2}), 'Side 2: A whole turn came out as 270.0°.');
  assert.equal(detailOf('focal-length', {shorter_share: 0.021, seen_px: 562.4, told_px: 574}),
      'The sensor’s focal length is 2.1% shorter than configured: 562 pixels instead of 574.');
  assert.equal(detailOf('no-map', {unevenness_disparity: 0.456}),
      'One look at a bare wall makes models more exact: the flat platform looks uneven by 0.7 mm at 75 cm.');
});
