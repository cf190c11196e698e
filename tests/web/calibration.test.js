import assert from 'node:assert/strict';
import {test} from 'node:test';

import * as requests from '../../web/api/api_calibration.js';
import * as texts from '../../web/scanner/calibration.js';
import {distanceText} from '../../web/sensor/depth.js';
import {distanceOf} from '../../web/sensor/depth_picture.js';
import {errorColour} from '../../web/sensor/map_picture.js';
import {calibration, turnReport} from './examples.js';

const run = {kind: 'turn', state: 'running', phase: 'turning', stop: 3, stops: 24, report: null, error: null};
const after = (changes) => texts.outcomeOf({...calibration, run: {...run, ...changes}}, 'turn');

test('a rig that nobody measured is not called calibrated', () => {
  const summary = texts.summaryOf(calibration);
  assert.deepEqual([summary.tone, summary.title], ['warn', 'Not calibrated yet']);
});

test('a measured rig says when, and how exactly', () => {
  const summary = texts.summaryOf({...calibration, source: 'turn', at: '2026-11-21T08:15:00Z', sigma_mm: 0.031, sigma_deg: 0.012});
  assert.equal(summary.tone, 'good');
  assert.match(summary.title, /^Measured with a turn, .*21/);
  assert.equal(summary.text, 'The axis is known to ±0.03 mm and ±0.01°.');
});

test('a pose set by hand has no figures', () => {
  const summary = texts.summaryOf({...calibration, source: 'page', at: '2026-11-21T08:15:00Z'});
  assert.equal(summary.tone, 'idle');
  assert.match(summary.text, /Only a turn/);
});

test('progress is of the kind that runs, grows, and never ends before the end', () => {
  const shares = [0, 3, 24].map((stop) => texts.progressOf({...calibration, run: {...run, stop}}, 'turn').share);
  assert.ok(shares[0] < shares[1] && shares[1] < shares[2] && shares[2] < 0.95);
  assert.equal(texts.progressOf({...calibration, run}, 'turn').text, 'Stop 4 of 24');
  assert.equal(texts.progressOf({...calibration, run}, 'wall'), null);
  assert.equal(texts.progressOf({...calibration, run: {...run, state: 'done'}}, 'turn'), null);
  assert.equal(texts.progressOf({...calibration, run: {...run, kind: 'wall', phase: 'looking'}}, 'wall').text, 'Looking at the wall, 3 of 24');
});

test('an accepted turn says what was wrong and how well it is now', () => {
  const outcome = after({state: 'done', report: turnReport});
  assert.equal(outcome.title, 'The axis was 18.4 mm and 2.01° off');
  assert.match(outcome.detail, /agree to 0\.52 mm; before, they were 6\.84 mm apart/);
});

test('a turn that confirms the pose says that nothing was changed', () => {
  const outcome = after({state: 'done', report: {...turnReport, shift_mm: 0.04, tilt_deg: 0.01}});
  assert.match(outcome.title, /Confirmed/);
  assert.match(outcome.detail, /Nothing was changed/);
});

test('a turn of a rig with lasers tells of their planes, too', () => {
  const outcome = after({state: 'done', report: {...turnReport, shift_mm: 0.01, tilt_deg: 0, confirms_told: false}});
  assert.equal(outcome.title, 'Camera and lasers were measured');
  assert.match(outcome.detail, /before, they were/);
  assert.match(after({state: 'done', report: {...turnReport, confirms_told: true}}).detail, /Nothing was changed/);
});

test('a rig with lasers calibrates itself, until it was measured', () => {
  const withLasers = {...calibration, lens: {told: null, kept: null}};
  assert.equal(texts.summaryOf(withLasers).title, 'Each scan calibrates itself');
  const measured = {...withLasers, source: 'scan', at: '2026-11-21T08:15:00Z', sigma_mm: 0.031, sigma_deg: 0.012};
  assert.equal(texts.summaryOf(measured).tone, 'good');
});

test('a refused turn says why and what to do', () => {
  const report = {...turnReport, accepted: false, reason: 'too little of an object was seen'};
  const outcome = after({state: 'refused', report});
  assert.deepEqual([outcome.tone, outcome.title, outcome.detail], ['warn', 'Nothing was changed', 'Too little of an object was seen.']);
  assert.match(outcome.hint, /object of 4 cm/);
  assert.equal(after({state: 'refused', report, error: {code: 'x', detail: '', hint: 'use a larger one'}}).hint, 'Use a larger one.');
});

test('a cancelled turn is no fault, a failed one is', () => {
  assert.equal(after({state: 'cancelled'}).tone, 'idle');
  const failed = after({state: 'failed', error: {code: 'sensor-lost', detail: 'the Kinect is gone', hint: 'plug it in'}});
  assert.deepEqual([failed.tone, failed.detail, failed.hint], ['bad', 'The Kinect is gone.', 'Plug it in.']);
  assert.equal(after({state: 'running'}), null);
});

test('figures are rounded to what they can mean', () => {
  const figures = Object.fromEntries(texts.figuresOf(turnReport).map(({label, text}) => [label, text]));
  assert.deepEqual(figures, {
    'Axis moved': '18.4 mm', 'Axis tilted': '2.01°', 'Known to': '±0.03 mm, ±0.01°', 'Views disagree by': '6.84 mm → 0.52 mm'});
});

test('each stop has a bar, and one that a finding names is marked', () => {
  const stops = [0, 0.1, -0.2, 1.84].map((off_deg, index) => ({angle_deg: 90 * index, off_deg}));
  const bars = texts.barsOf({...turnReport, stops, findings: [{code: 'slip', detail: '', hint: '', stop: 3}]});
  assert.equal(bars.usual.match(/M/g).length, 3);
  assert.equal(bars.marked, 'M79.50 50V4.00h16.00V50Z');  // the fourth quarter of the width, at the largest value
  assert.equal(bars.label, '4 stops, the largest 1.84° off');
});

const lengths = (...pairs) => pairs.map(([model_mm, caliper_mm]) => ({model_mm, caliper_mm}));

test('one known length gives the scale, on top of the one in force', () => {
  assert.deepEqual(texts.scaleOf(lengths([100, 101]), 1), {scale: 1.01, problem: ''});
  assert.deepEqual(texts.scaleOf(lengths([101, 100]), 1.01), {scale: 1, problem: ''});
  assert.match(texts.scaleOf(lengths([100, 112]), 1).problem, /12%, more than|12\.0%, more than/);
  assert.match(texts.scaleOf(lengths([Number.NaN, 104]), 1).problem, /Both/);
});

test('several known lengths give the scale with the smallest errors, and a row left empty counts for nothing', () => {
  assert.deepEqual(texts.scaleOf(lengths([100, 101], [50, 50.5], [Number.NaN, Number.NaN]), 1), {scale: 1.01, problem: ''});
  // 200 mm tell it sixteen times as well as 50 mm: (200 * 202 + 50 * 50) / (200^2 + 50^2)
  assert.equal(texts.scaleOf(lengths([200, 202], [50, 50]), 1).scale, 1.00941);
  assert.match(texts.scaleOf(lengths([100, 101], [Number.NaN, 30]), 1).problem, /Both/);
  assert.match(texts.scaleOf(lengths([Number.NaN, Number.NaN]), 1).problem, /Both/);
});

test('known lengths tell how exact a model is, before and after the scale', () => {
  const gauge = texts.gaugeOf(lengths([90.9, 90], [60.6, 60], [Number.NaN, 30]));
  assert.deepEqual(gauge.off, ['+0.90 mm', '+0.60 mm', '']);
  assert.equal(gauge.text, 'The model is off by 0.75 mm on average, and by 0.90 mm at most. With the scale set: 0.00 mm and 0.00 mm.');
  assert.deepEqual(texts.gaugeOf(lengths([29.8, 30])), {off: ['−0.20 mm'], text: 'The model is off by 0.20 mm.'});
  assert.deepEqual(texts.gaugeOf(lengths([Number.NaN, 30])), {off: [''], text: ''});
});

test('a scale is told as what it does', () => {
  assert.match(texts.scaleText(1), /size that the sensor tells/);
  assert.match(texts.scaleText(1.012), /1\.20% larger/);
  assert.match(texts.scaleText(0.99), /1\.00% smaller/);
});

test('earlier poses are told by their origin and what they cured', () => {
  const [first, second] = texts.historyOf({...calibration, history: [
    {...calibration, source: 'turn', at: '2026-11-21T08:15:00Z', before_mm: 6.84, after_mm: 0.52}, {...calibration, scale: 1.01}]});
  assert.match(first.title, /^Measured with a turn/);
  assert.equal(first.text, '6.84 mm → 0.52 mm');
  assert.deepEqual([second.title, second.text], ['Taken from the drawing', 'scale 1.0100']);
});

test('where no earlier pose is kept, that of the settings is below', () => {
  assert.match(texts.noPosesText(calibration), /^None yet/);
  assert.match(texts.noPosesText({...calibration, source: 'scan'}), /pose of the settings/);
});

test('brightness tells the distance, within what the picture can show', () => {
  assert.equal(distanceOf(0), null);
  assert.ok(Math.abs(distanceOf(255) - 0.45) < 1e-9);
  assert.ok(Math.abs(distanceOf(24) - 2) < 1e-9);
  assert.deepEqual([null, 0.4502, 0.655, 1.234, 2].map(distanceText), ['No reading', '45.0 cm', '65.5 cm', '123 cm', '2 m or more']);
});

test('only what was found with this rig counts as calibrated', () => {
  assert.deepEqual(['default', 'settings', 'page', 'turn', 'scan'].filter((source) => requests.isCalibrated({...calibration, source})),
      ['page', 'turn', 'scan']);
});

test('of a refused turn only what it found is shown, and nothing of a wall', () => {
  const refused = {...turnReport, accepted: false, stops: [], findings: []};
  const slipped = {...refused, findings: [{code: 'moved', detail: '', hint: ''}]};
  assert.deepEqual(texts.figuresOf(refused), []);
  assert.equal(texts.foundBy(null), null);
  assert.equal(texts.foundBy({...run, state: 'refused', report: refused}), null);
  assert.equal(texts.foundBy({...run, state: 'refused', report: slipped}), slipped);
  assert.equal(texts.foundBy({...run, state: 'done', report: turnReport}), turnReport);
  assert.equal(texts.foundBy({...run, state: 'failed', report: null}), null);
  assert.equal(texts.foundBy({...run, kind: 'wall', state: 'done', report: wallReport}), null);
});

const wallReport = {accepted: true, reason: '', rms_before: 0.812, rms_after: 0.214, walls: [{distance_m: 0.65}]};
const looked = (changes) => texts.outcomeOf({...calibration, run: {...run, kind: 'wall', phase: 'looking', ...changes}}, 'wall');

test('a look at a wall says what it took out, and asks for a second one once', () => {
  const first = looked({state: 'done', report: wallReport});
  assert.equal(first.title, 'The sensor’s unevenness is corrected');
  assert.match(first.detail, /1\.3 mm at 75 cm, .* within 0\.3 mm/);
  assert.match(first.hint, /second view/);
  assert.equal(looked({state: 'done', report: {...wallReport, walls: [{distance_m: 0.9}, {distance_m: 0.65}]}}).hint, '');
  assert.equal(texts.outcomeOf({...calibration, run: {...run, kind: 'wall', state: 'done', report: wallReport}}, 'turn'), null);
});

test('a wall that is none is told in the scanner\'s words', () => {
  const refused = looked({state: 'refused', report: {...wallReport, accepted: false, reason: 'that is no flat wall: 30 % of the picture lies off its plane'}});
  assert.deepEqual([refused.tone, refused.detail], ['warn', 'That is no flat wall: 30 % of the picture lies off its plane.']);
  assert.match(refused.hint, /bare, matt wall/);
});

test('a map is told with its date, its sensor and what it did', () => {
  assert.match(texts.mapText(calibration), /^Not done/);
  const map = {serial: 'A00361', at: '2026-11-21T08:15:00Z', rms_before: 0.812, rms_after: 0.214};
  assert.match(texts.mapText({...calibration, sensor_map: map}), /^Done on .*21.* for sensor A00361: 1\.3 mm → 0\.3 mm at 75 cm/);
});

test('measured optics are told with their date and sigmas, and nothing without them', () => {
  assert.equal(texts.opticsText(calibration), '');
  const value = {fx: 590.24, fy: 590.1, cx: 331.8, cy: 245.96, k1: -0.05, k2: 0, depth_scale: 1, depth_offset_per_m: 0};
  const optics = {...value, sigma: {...value, fx: 0.83, cx: 0.71}, source: 'scan', at: '2026-11-28T08:15:00Z', history: []};
  assert.match(texts.opticsText({...calibration, optics}),
    /measured by a scan on .*28.*: focal length 590\.2 ± 0\.8 pixels, middle of the picture 331\.8, 246\.0 ± 0\.7 pixels\.$/);
});

test('how long the sensor has been on is told where it is known', () => {
  assert.equal(texts.warmText(null), '');
  assert.match(texts.warmText(20), /less than a minute; this page keeps it on\.$/);
  assert.match(texts.warmText(65), /for 1 minute;/);
  assert.equal(texts.warmText(725), 'It has been on for 12 minutes.');
});

test('an error of the sensor is blue where too far, amber where too near, and pale at none', () => {
  const [far, none, near] = [-2, 0, 5].map(errorColour);
  assert.ok(far[2] > far[0] && near[0] > near[2]);
  assert.ok(Math.min(...none) > 230);
});

test('those who look from time to time share a response, but not one from before a change', async (t) => {
  let scale = 1;
  const asked = t.mock.method(globalThis, 'fetch', () => Promise.resolve(Response.json({scale})));
  const looked = () => requests.recentCalibration();
  assert.deepEqual([await looked(), await looked()], [{scale: 1}, {scale: 1}]);
  assert.equal(asked.mock.callCount(), 1);
  scale = 1.01;
  await requests.change({scale});
  assert.deepEqual(await looked(), {scale: 1.01});

  await requests.change({scale});
  asked.mock.mockImplementation(() => Promise.reject(new TypeError('away')));
  await assert.rejects(looked());
  asked.mock.mockImplementation(() => Promise.resolve(Response.json({scale})));
  assert.deepEqual(await looked(), {scale: 1.01});
});
