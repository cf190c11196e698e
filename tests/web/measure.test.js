import assert from 'node:assert/strict';
import {test} from 'node:test';

import {measureText, withPoint} from '../../web/model/measure.js';

test('two places are measured between, and a third one begins anew', () => {
  const [a, b, c] = [[0, 0, 0], [3, -4, 12], [1, 1, 1]];
  const pair = withPoint(withPoint([], a), b);
  assert.deepEqual(pair, [a, b]);
  assert.equal(measureText(pair), '13.0 mm (ΔX 3.0, ΔY 4.0, ΔZ 12.0)');
  assert.deepEqual(withPoint(pair, c), [c]);
  assert.notEqual(measureText([]), measureText([a]));
});
