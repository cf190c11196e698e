import assert from 'node:assert/strict';
import {test} from 'node:test';

import {screenOf} from '../../web/screen.js';
import * as states from '../../web/state.js';
import {finished, settings, status} from './examples.js';

const askew = {
  ...finished,
  settings: {...settings, calibrate: 'told'},
  model: {...finished.model, quality: {verdict: 'bad', reasons: [
    {code: 'stops-disagree', detail: 'two stops are 7 mm apart', hint: 'Calibrate.', places_mm: [[1, 2, 3], [4, 5, 6]]},
    {code: 'little-seen', detail: 'half of it', hint: ''}]}},
  build: 0,
};

/** A build as in the API. */
const build = (number, changes) => ({
  scan: 'done', build: number, state: 'finished', phase: 'done', created: '2026-11-22T08:15:00Z', snapshots_done: 36,
  snapshots_total: 36, settings: askew.settings, error: null, calibration: null, model: {...askew.model, url: `builds/${number}`},
  chosen: number === 0, ...changes,
});

const own = build(0, {});
const straight = build(1, {
  settings: {...settings, calibrate: 'auto', leaf_size_mm: 2},
  calibration: {accepted: true, confirms_told: false, reason: '', solved: {after_mm: 0.5}},
  model: {...finished.model, url: 'builds/1', triangles: 5, quality: {verdict: 'good', reasons: []}},
});
const going = build(1, {state: 'running', phase: 'rebuilding', snapshots_done: 9, model: null});

const looking = (scan, more = {}) => states.withSelected(
    states.withScans(states.withStatus(states.initial, {...status, ...more}), [scan]), scan.id);
const withList = (list, more) => states.withBuilds(looking(askew, more), 'done', list);
const factsOf = (state) => Object.fromEntries(screenOf(state).details.facts.map(({label, text}) => [label, text]));

test('a scan that went by a told pose and disagrees with it can be straightened', () => {
  assert.ok(screenOf(looking(askew)).builds.canStraighten);
  assert.ok(screenOf(looking({...askew, settings})).builds.canStraighten, 'an earlier version has made it');
  assert.ok(!screenOf(looking({...askew, settings, calibration: straight.calibration})).builds.canStraighten);
  assert.ok(!screenOf(looking(finished)).builds.canStraighten);
});

test('the facts of a model of several sides count the snapshots and the time of all', () => {
  const side = {...finished, id: 'side', snapshots_done: 12, snapshots_total: 12, seconds_elapsed: 25,
    pose_of: {scan: 'done', registration: null}};
  const pose = {pose: 1, scan: 'side', state: 'finished', registration: null};
  const first = {...askew, seconds_elapsed: 95, poses: [pose]};
  const both = states.withScans(states.withStatus(states.initial, status), [first, side]);
  const state = states.withBuilds(states.withSelected(both, 'done'), 'done', [own, {...straight, poses: [1]}]);
  assert.match(factsOf(states.withShownBuild(state, 1)).Snapshots, /^48 of 48/);
  assert.match(factsOf(states.withShownBuild(state, 1)).Taken, /2 min/);
  assert.match(factsOf(states.withShownBuild(state, 0)).Snapshots, /^36 of 36/);
});

test('a scan is built again once it has ended and has snapshots', () => {
  const canBuild = (changes) => screenOf(looking({...askew, ...changes})).builds.canBuild;
  assert.deepEqual([{}, {state: 'cancelled'}, {state: 'failed'}, {state: 'paused'}, {snapshots_done: 0}].map(canBuild),
      [true, true, true, false, false]);
});

test('one model needs no list, and of several one is looked at', () => {
  assert.deepEqual(screenOf(withList([own])).builds.rows, []);
  const {builds} = screenOf(withList([own, straight]));
  assert.deepEqual(builds.rows.map(({name, isShown, isChosen, canRemove}) => [name, isShown, isChosen, canRemove]),
      [['As scanned', true, true, false], ['Build 1', false, false, true]]);
  assert.equal(builds.rows[1].about, '2 mm, solid · pose checked · 51 MB');
  const cut = {...straight, settings: {...straight.settings, cut_mm: [[0, 0, 1, 40]]}};
  assert.match(screenOf(withList([own, cut])).builds.rows[1].about, /edited/);
});

test('another model is shown with its own facts and verdict, and can be downloaded', () => {
  const state = states.withShownBuild(withList([own, straight]), 1);
  const {details, stage} = screenOf(state);
  assert.equal(details.verdict.tone, 'good');
  assert.equal(details.download.url, 'builds/1');
  assert.equal(stage.model.url, 'api/v1/scans/done/builds/1/Scan.stl');
  assert.equal(factsOf(state).Triangles, '5');
  assert.equal(factsOf(state).Detail, '2 mm, solid');
  assert.match(factsOf(state).Pose, /^Corrected by this scan/);
  assert.equal(screenOf(withList([own, straight])).stage.model.url, 'api/v1/scans/done/builds/0/Scan.stl');
});

test('a build tells how far it is, and why it failed', () => {
  assert.deepEqual(screenOf(looking(askew, {build: going})).builds.going, {number: 1, text: 'Reading snapshot 9 of 36', share: 0.25});
  const error = {code: 'disk-full', detail: 'the disk is full', hint: 'Delete scans'};
  const {builds} = screenOf(looking(askew, {build: {...going, state: 'failed', error}}));
  assert.deepEqual([builds.going, builds.trouble],
      [null, {title: 'The model was not built', text: 'The disk is full. Delete scans.'}]);
  assert.equal(screenOf(looking(askew, {build: {...going, scan: 'other'}})).builds.going, null);
});

test('the list is stale when a build came or ended, and what ended comes into view', () => {
  const before = withList([own], {});
  assert.ok(!states.areBuildsStale(before));
  const during = states.withStatus(before, {...status, build: going});
  assert.ok(states.areBuildsStale(during));
  const after = states.withStatus(states.withBuilds(during, 'done', [own, going]), {...status, build: {...going, state: 'finished'}});
  assert.ok(states.areBuildsStale(after));
  assert.equal(states.withBuilds(after, 'done', [own, straight]).shownBuild, 1);
  const other = states.withScan(before, {...finished, id: 'other'});
  assert.ok(states.areBuildsStale(states.withSelected(other, 'other')));
});

test('a build that was begun here comes into view, however quick it was', () => {
  const begun = states.withBuild(withList([own]), {...going, state: 'waiting'});
  assert.equal(states.withBuilds(begun, 'done', [own, straight]).shownBuild, 1);
});

test('a reason that knows its places shows them, and hides them again', () => {
  const {reasons} = screenOf(looking(askew)).details.verdict;
  assert.deepEqual(reasons.map(({places}) => places.length), [2, 0]);
  const shown = states.withReason(looking(askew), reasons[0].key);
  assert.deepEqual(screenOf(shown).stage.places, [[1, 2, 3], [4, 5, 6]]);
  assert.deepEqual(screenOf(shown).details.verdict.reasons.map(({isShown}) => isShown), [true, false]);
  assert.deepEqual(screenOf(states.withReason(shown, reasons[0].key)).stage.places, []);
  assert.deepEqual(screenOf(states.withSelected(shown, null)).stage.places, []);
});

test('builds on a cluster go on side by side, each told with its scan', () => {
  const queued = {...going, state: 'waiting', cluster_job: {id: '12', detail: 'it waits for processors or memory'}};
  const elsewhere = {...going, scan: 'other', cluster_job: {id: '13', detail: ''}};
  const builds = (cluster_builds, more = {}) => screenOf(looking({...askew, ...more}, {cluster_builds})).builds;
  assert.equal(builds([elsewhere, queued]).going.text, 'In the queue of Slurm: it waits for processors or memory');
  assert.ok(builds([elsewhere, queued]).isBusy);
  assert.ok(!builds([elsewhere]).isBusy, 'one of another scan is in nobody\'s way');
  assert.equal(builds([elsewhere]).going, null);
  const error = {code: 'interrupted', detail: 'its job was cancelled', hint: ''};
  assert.equal(builds([{...queued, state: 'cancelled', error}]).trouble.text, 'Its job was cancelled. ');
  assert.ok(builds([queued], {state: 'interrupted', model: null}).canBuild, 'a scan that came from a file shows its first build');
});

test('a build on a cluster that ends makes the list stale', () => {
  const queued = {...going, cluster_job: {id: '12', detail: ''}};
  const state = states.withBuild(withList([own], {cluster_builds: []}), queued);
  assert.deepEqual(state.status.cluster_builds, [queued]);
  const read = states.withBuilds(state, 'done', [own, queued]);
  assert.ok(!states.areBuildsStale(read));
  const ended = states.withStatus(read, {...status, cluster_builds: []});
  assert.ok(states.areBuildsStale(ended));
  assert.equal(states.withBuilds(ended, 'done', [own, straight]).shownBuild, 1);
});
