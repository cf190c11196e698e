import assert from 'node:assert/strict';
import {test} from 'node:test';

import {rowOf} from '../../web/scan/bin.js';

test('what is in the bin says for how long it is kept', () => {
  const scan = {id: 'a', name: '', created: '2026-11-21T08:15:00Z', state: 'finished', snapshots_done: 36, deleted: '2026-11-22T08:00:00Z', kept_until: '2026-12-22T08:00:00Z'};
  const {name, about} = rowOf(scan, new Date('2026-12-20T09:00:00Z'));
  assert.match(name, /^Scan of .*2026/);
  assert.equal(about, '36 snapshots · kept for 2 days more');
  assert.match(rowOf(scan, new Date('2027-01-01')).about, /0 days/);
});
