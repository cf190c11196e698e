import assert from 'node:assert/strict';
import {test} from 'node:test';

import {isPartOfAnother, posesOf} from '../../web/scan/poses.js';
import {initial, withStatus} from '../../web/state.js';
import {finished, running, status} from './examples.js';

const fits = {accepted: true, reason: '', overlap: 0.7, residual_mm: 0.53, symmetric: false};
const pose = {pose: 1, scan: 'other', state: /** @type {const} */ ('finished'), registration: fits};

test('a finished scan offers the underside, and another pose does not', () => {
  assert.ok(posesOf(initial, finished).canAdd);
  assert.ok(!posesOf(initial, {...finished, pose_of: {scan: 'first', registration: fits}}).canAdd);
  assert.ok(!posesOf(initial, running).canAdd);
});

test('what fits is told with its figures, and what does not with the reason', () => {
  const [row] = posesOf(initial, {...finished, poses: [pose]}).rows;
  assert.equal(row.tone, 'good');
  assert.match(row.text, /70%.*0\.53 mm/);
  const [refused] = posesOf(initial, {...finished, poses: [{...pose, registration: {accepted: false, reason: 'too little is shared'}}]}).rows;
  assert.equal(refused.tone, 'warn');
  assert.match(refused.text, /Too little is shared\. The model stayed as it was/);
});

test('only the last side that was merged can be taken back', () => {
  const second = {...pose, pose: 2};
  const rows = posesOf(initial, {...finished, poses: [pose, second]}).rows;
  assert.deepEqual(rows.map(({canRemove}) => canRemove), [false, true]);
});

test('a pose that was merged is listed with its scan, and its end shows that', () => {
  const other = {...running, pose_of: {scan: 'done', registration: null}};
  assert.ok(isPartOfAnother({...finished, pose_of: {scan: 'done', registration: fits}}));
  assert.ok(!isPartOfAnother({...other, state: 'interrupted'}));
  const during = withStatus(initial, {...status, scan: other});
  assert.equal(withStatus(during, status).selected, 'done');
});
