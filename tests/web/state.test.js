import assert from 'node:assert/strict';
import {test} from 'node:test';

import * as states from '../../web/state.js';
import {finished, running, status} from './examples.js';

const {initial} = states;
const scanning = states.withStatus(initial, {...status, scan: running});

test('a running scan is in the list as the status tells it', () => {
  const later = states.withStatus(scanning, {...status, scan: {...running, snapshots_done: 10}});
  assert.deepEqual(later.scans.map(({id, snapshots_done}) => `${id} ${snapshots_done}`), ['run 10']);
});

test('a scan that ends while it is looked at stays in view, with its model', () => {
  const ended = states.withStatus(scanning, {...status, newest: 'run'});
  assert.equal(ended.selected, 'run');
  assert.equal(ended.stage, 'model');
});

test('a scan that ends while another is looked at does not take its place', () => {
  const elsewhere = states.withSelected(states.withScan(scanning, finished), 'done');
  assert.equal(states.withStatus(elsewhere, status).selected, 'done');
});

test('a scan that pauses stays in view, and is looked at as the running one once it is resumed', () => {
  const listed = states.withScans(states.withStatus(scanning, status), [{...running, state: 'paused'}]);
  assert.equal(listed.selected, 'run');
  const resumed = states.withStarted(listed, running);
  assert.equal(resumed.selected, null);
  assert.equal(states.running(resumed).id, 'run');
  assert.deepEqual(resumed.scans.map(({state}) => state), ['running']);
});

test('the running scan is looked at by looking at nothing else', () => {
  assert.equal(states.withSelected(scanning, 'run').selected, null);
});

test('the list is stale when a scan came or ended, and fresh once it is read', () => {
  assert.ok(states.isListStale(scanning));
  const listed = states.withScans(scanning, [running]);
  assert.ok(!states.isListStale(listed));
  assert.ok(!states.isListStale(states.withStatus(listed, {...status, scan: {...running, snapshots_done: 30}})));
  assert.ok(states.isListStale(states.withStatus(listed, {...status, scan: running, scans_revision: 2})), 'renamed or deleted by somebody else');
});

test('after a refusal the list is read again: what was to be deleted may be gone already', () => {
  const listed = states.withScans(states.withStatus(initial, status), [finished]);
  assert.ok(!states.isListStale(listed));
  assert.ok(states.isListStale(states.withStaleList(listed)));
});

test('a scan that is looked at and runs, by its address or since somebody else resumed it, shows its progress', () => {
  const byAddress = states.withSelected(initial, 'run');
  assert.equal(states.withStatus(byAddress, {...status, scan: running}).selected, null);
  const paused = states.withSelected(states.withScans(states.withStatus(initial, status), [{...running, state: 'paused'}]), 'run');
  assert.equal(states.withStatus(paused, {...status, scan: running}).selected, null);
});

test('a scan that is no longer there is no longer looked at', () => {
  const looking = states.withSelected(states.withScans(states.withStatus(initial, status), [finished]), 'done');
  assert.equal(states.withScans(looking, []).selected, null);
  assert.equal(states.withoutScan(looking, 'done').selected, null);
  assert.equal(states.withoutScan(looking, 'other').selected, 'done');
});

test('one unanswered request is an accident, two mean that the scanner is away, an answer ends it', () => {
  const once = states.withoutAnswer(scanning);
  const twice = states.withoutAnswer(once);
  assert.deepEqual([once, twice, states.withStatus(twice, status)].map(states.isAway), [false, true, false]);
});

test('it asks twice a second while a scan runs, and ever more slowly while nobody answers', () => {
  assert.ok(states.pause(scanning) <= 500);
  assert.ok(states.pause(states.withStatus(initial, status)) <= 1000);
  const pauses = [];
  for (let state = states.withoutAnswer(scanning); pauses.length < 8; state = states.withoutAnswer(state)) {
    pauses.push(states.pause(state));
  }
  assert.deepEqual(pauses, [...pauses].sort((a, b) => a - b));
  assert.equal(pauses.at(-1), 8000);
});

test('a phone does not load 50 MB unasked, a desktop does', () => {
  assert.deepEqual([true, false].map((isHandheld) => states.loadsUnasked(50e6, isHandheld)), [false, true]);
});

test('what is asked for clears the problem of what was asked before', () => {
  const problem = {title: 'The scan did not start', detail: '', hint: ''};
  const asking = states.withPending(states.withProblem(initial, problem));
  assert.equal(asking.problem, null);
  assert.equal(asking.isPending, true);
  assert.equal(states.withProblem(states.withAnswer(asking), problem).isPending, false);
});

test('a model of more bytes than its coarse mesh has one, beside it', () => {
  assert.deepEqual([states.hasCoarse(200e3), states.hasCoarse(1.4e6)], [false, true]);
  assert.equal(states.coarseUrl({url: '/api/v1/scans/a/builds/2/Scan.stl'}), '/api/v1/scans/a/builds/2/coarse.stl');
});

test('an address of no scan selects none, and nobody asks for its builds', () => {
  const listed = states.withScans(states.withStatus(initial, status), [finished]);
  assert.equal(states.withSelected(listed, 'nonsense').selected, null);
  const early = states.withSelected(initial, 'nonsense');  // before the list is known
  assert.equal(states.withScans(states.withStatus(early, status), [finished]).selected, null);
  assert.ok(!states.areBuildsStale({...listed, selected: 'nonsense'}));
});

test('a scan that was asked to stop is stopping until it has', () => {
  const asked = states.withStopping(scanning, 'run');
  assert.equal(states.withStatus(asked, {...status, scan: running}).stopping, 'run');
  const paused = states.withStatus(asked, status);
  assert.equal(paused.stopping, null);
  assert.equal(states.withStatus(paused, {...status, scan: running}).stopping, null, 'resumed');
});

test('a scan that is not finished is found, and a side of another is not', () => {
  const paused = {...running, state: 'paused'};
  const listed = states.withScans(states.withStatus(initial, status), [finished, paused]);
  assert.equal(states.unfinished(listed)?.id, 'run');
  const side = states.withScans(listed, [finished, {...paused, pose_of: {scan: 'done'}}]);
  assert.equal(states.unfinished(side), null);
});
