import assert from 'node:assert/strict';
import {test} from 'node:test';

import {choiceOf, choicesOf, fitsOf, isOfSide, textOf, withPairs, withPoint, withStep, withoutPoint} from '../../web/scan/fits.js';

const at = (/** @type {number} */ x) => [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]];
const candidates = [
  {object_from_platform: at(0.1), overlap: 0.7, residual_mm: 0.9, contradiction: 0.02},
  {object_from_platform: at(0.2), overlap: 0.5, residual_mm: 1.2, contradiction: 0.5},
];
/** @param {number | null} candidate */
const merged = (candidate) => /** @type {import('../../web/api/api_poses.js').Pose} */ ({
  pose: 1, scan: 'other', state: 'finished', registration: {
    accepted: true, reason: '', overlap: 0.71, residual_mm: 0.4, contradiction: 0.01, symmetric: false, candidates, candidate,
    object_from_platform: at(0.11),
  },
});

test('the fit of the model is shown first, and another one can be asked for', () => {
  const fits = fitsOf(merged(0));
  assert.match(textOf(fits, 2), /Fit 1 of 2, as in the model: 71% .* to 0\.40 mm; 1% /);
  assert.equal(choiceOf(fits), null);
  assert.deepEqual(fits.all[0].object_from_platform, at(0.11));
  const next = withStep(fits, 1);
  assert.match(textOf(next, 2), /Fit 2 of 2, another way: 50% .*25% .*No further fit/);
  assert.deepEqual(choiceOf(next), {candidate: 1});
  assert.ok(!choicesOf(next).isWrong && choicesOf(next).isBack);
  assert.equal(withStep(next, 1).shown, 1);
  assert.equal(withStep(next, -1).shown, 0);
});

test('a fit that was made of pairs is one more', () => {
  const fits = fitsOf(merged(null));
  assert.equal(fits.all.length, 3);
  assert.deepEqual(choiceOf(withStep(fits, 1)), {candidate: 0});
});

test('of a side that does not fit, any candidate can be taken', () => {
  const fits = fitsOf({...merged(0), registration: {accepted: false, reason: 'two poses fit alike', candidates}});
  assert.match(textOf(fits, 2), /Fit 1 of 2, not in the model/);
  assert.deepEqual(choiceOf(fits), {candidate: 0});
  assert.match(textOf(fitsOf({...merged(0), registration: {accepted: false, reason: 'too little'}}), 2), /No way to fit/);
});

test('three pairs are clicked in turn, and can be taken back', () => {
  let fits = withPairs(fitsOf(merged(0)), true);
  assert.equal(withPoint(fitsOf(merged(0)), [0, 0, 0]).points, null, 'a click on a fit sets nothing');
  for (let i = 0; i < 6; ++i) {
    assert.equal(choiceOf(fits), null);
    assert.equal(isOfSide(fits), i % 2 === 1);
    assert.match(textOf(fits, 2), new RegExp(`Pair ${Math.floor(i / 2) + 1} of 3`));
    fits = withPoint(fits, [i, 0, 0]);
  }
  assert.deepEqual(choiceOf(fits), {pairs_mm: [[[0, 0, 0], [1, 0, 0]], [[2, 0, 0], [3, 0, 0]], [[4, 0, 0], [5, 0, 0]]]});
  assert.equal(withPoint(fits, [9, 9, 9]).points?.length, 6);
  assert.equal(withoutPoint(fits).points?.length, 5);
  assert.equal(choicesOf(withPairs(fits, true)).back, 'Back to the fits');
});
