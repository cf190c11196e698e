import assert from 'node:assert/strict';
import {test} from 'node:test';

import {
  foundLens, keptText, lensFiguresOf, lensOutcomeOf, lensProgressOf, missingPart, opticsFiguresOf,
} from '../../web/scanner/lens_words.js';
import {calibration} from './examples.js';
import * as de from '../../web/texts/de.js';
import * as es from '../../web/texts/es.js';
import * as fr from '../../web/texts/fr.js';

const told = {fx: 682.4, fy: 682.4, cx: 409.5, cy: 307.5, k1: 0, k2: 0};
const lens = {fx: 690.59, fy: 689.22, cx: 414.4, cy: 303.8, k1: -0.06, k2: 0.02};
const sigma = {fx: 0.04, fy: 0.04, cx: 0.05, cy: 0.05, k1: 0.0004, k2: 0.0012};
const report = {accepted: true, reason: '', lens, sigma, rms_px: 0.07, views: 14};
const nothing = new Array(36).fill(0);
const look = {advice: 'hold-still', corners: [], coverage: nothing};
const run = {kind: 'lens', state: 'running', phase: 'looking', stop: 3, stops: 12, report: null, look, error: null};
const during = (changes) => ({...calibration, lens: {told, kept: null}, run: {...run, ...changes}});

test('a lens is the settings\' until one is kept', () => {
  assert.match(keptText(during({})), /As configured/);
  const kept = {...lens, serial: 'usb-1', at: '2026-11-26T05:00:00Z', rms_px: 0.07};
  assert.match(keptText({...calibration, lens: {told, kept}}), /for camera usb-1; corners lie within 0\.07 pixels/);
});

test('each advice has words, and what is taken is counted', () => {
  const said = ['show', 'hold-still', 'tilt', 'turn'].map((advice) => lensProgressOf(during({look: {...look, advice}})).advice);
  assert.equal(new Set(said).size, 4);
  const {taken, share, canSolve} = lensProgressOf(during({look: {...look, coverage: nothing.map((_, cell) => cell < 18 ? 1 : 0)}}));
  assert.equal(taken, '3 of 12 pictures taken, 50% of the picture seen');
  assert.ok(share > 0 && share < 0.5);
  assert.equal(canSolve, false);
  assert.equal(lensProgressOf(during({stop: 5})).canSolve, true);
  assert.equal(lensProgressOf(during({kind: 'wall'})), null);
  assert.equal(lensProgressOf(during({state: 'done'})), null);
  assert.equal(lensProgressOf(calibration), null);
});

test('the part of the picture that is missing is named', () => {
  const without = (/** @type {number[]} */ ...cells) => nothing.map((_, cell) => cells.includes(cell) ? 0 : 1);
  assert.equal(missingPart(without(0, 1)), 0);
  assert.equal(missingPart(without(5, 11)), 2);
  assert.equal(missingPart(without(14, 15, 20)), 4);
  assert.equal(missingPart(without(35)), 8);
  assert.equal(lensProgressOf(during({look: {advice: 'reach', corners: [], coverage: without(30, 31)}})).advice, 'Show it at the bottom left of the picture');
});

test('a lens that was found says how exactly, and waits to be kept', () => {
  const found = during({state: 'done', report});
  assert.equal(foundLens(found), report);
  assert.equal(lensOutcomeOf(found).tone, 'good');
  assert.match(lensOutcomeOf(found).detail, /From 14 pictures; .* 0\.07 pixels .*, 0\.03 mm at 30 cm/);
  const figures = lensFiguresOf(report, told);
  assert.equal(figures.length, 6);
  assert.deepEqual([figures[0].text, figures[0].configured], ['690.59 ± 0.04', 'configured 682.40']);
});

test('a lens that is refused, cancelled or failed is not to be kept', () => {
  const refused = during({state: 'refused', report: {...report, accepted: false, reason: 'a board was seen in 4 pictures: at least 5 have to show it'}});
  assert.equal(foundLens(refused), null);
  assert.deepEqual([lensOutcomeOf(refused).tone, lensOutcomeOf(refused).detail], ['warn', 'A board was seen in 4 pictures: at least 5 have to show it.']);
  assert.equal(lensOutcomeOf(during({state: 'cancelled'})).tone, 'idle');
  const failed = during({state: 'failed', error: {code: 'sensor-lost', detail: 'the camera is gone', hint: 'plug it in'}});
  assert.deepEqual([lensOutcomeOf(failed).tone, lensOutcomeOf(failed).detail, lensOutcomeOf(failed).hint], ['bad', 'The camera is gone.', 'Plug it in.']);
  assert.equal(lensOutcomeOf(during({})), null);
  assert.equal(lensOutcomeOf({...calibration, run: {...run, kind: 'turn', state: 'done'}}), null);
});

test('a Kinect\'s optics have a scale, and nothing configured', () => {
  const optics = {
    fx: 590.77, fy: 590.77, cx: 331.67, cy: 244.82, k1: -0.0623, k2: 0.007,
    depth_scale: 1.01405, depth_offset_per_m: 0.004,
  };
  const record = {...optics, sigma: {...optics, fx: 1.05, depth_scale: 0.0023}};
  const figures = opticsFiguresOf({...report, optics: record});
  assert.deepEqual([figures[0].text, figures[0].configured], ['590.77 ± 1.05', '']);
  assert.equal(figures.at(-1).text, '1.0141 ± 0.0023');
  assert.deepEqual(opticsFiguresOf({...report, optics: null}), []);
  assert.match(keptText({...calibration, lens: null, optics: null}), /Not measured/);
  const kept = {...record, source: 'board', at: '2026-11-28T22:47:46Z', history: []};
  assert.match(keptText({...calibration, lens: null, optics: kept}), /Measured with a board/);
  const improved = {...kept, source: 'scan', at: '2026-11-29T08:00:00Z', history: [kept]};
  assert.equal(keptText({...calibration, lens: null, optics: improved}), keptText({...calibration, lens: null, optics: kept}));
});

test('a Kinect\'s outcome is worded for its optics, in each language', () => {
  const kinect = (changes) => ({...during(changes), lens: null});
  const found = lensOutcomeOf(kinect({state: 'done', report: {...report, optics: {...lens, sigma, depth_scale: 1.01}}}));
  assert.match(found.detail, /^From 14 pictures; .* 0\.07 pixels from where these optics show them\.$/);
  assert.match(found.hint, /measure the pose again with a turn/);
  const reason = 'the sensor measured the board\'s depth in fewer than 5 places';
  const refused = lensOutcomeOf(kinect({state: 'refused', report: {...report, accepted: false, reason}}));
  assert.match(refused.title, /optics are not known/);
  assert.match(refused.hint, /still for two seconds/);
  for (const language of [de, es, fr]) {
    assert.ok(language.said[reason.replace('5', '{}')]);
  }
});
