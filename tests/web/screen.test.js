import assert from 'node:assert/strict';
import {test} from 'node:test';

import {screenOf} from '../../web/screen.js';
import * as states from '../../web/state.js';
import {finished, running, status} from './examples.js';

const idle = states.withDefaults(states.withStatus(states.initial, status), null, ['stl', '3mf', 'ply', 'glb', 'obj']);
const scanning = (changes) => states.withStatus(states.initial, {...status, scan: {...running, ...changes}});
const looking = (scan) => states.withSelected(states.withScans(idle, [scan]), scan.id);

test('what a running scan has seen is shown in 3D from its first snapshot on', () => {
  const preview = {url: '/api/v1/scans/run/preview.stl', snapshots: 3};
  const first = screenOf(scanning({})).stage;
  assert.deepEqual([first.growing, first.shows, first.hasChoice], [null, 'camera', false]);
  const later = screenOf(states.withSelected(scanning({preview}), null)).stage;
  assert.equal(later.growing, preview);
  assert.deepEqual([later.shows, later.hasChoice, later.model], ['model', true, null]);
  assert.equal(screenOf(looking(finished)).stage.growing, null);
});

test('the panel is the form, the progress or a scan, as things are', () => {
  assert.deepEqual([states.initial, idle, scanning({}), looking(finished)].map((state) => screenOf(state).panel),
      ['waiting', 'form', 'progress', 'details']);
});

test('progress tells the stop, the share and the time left', () => {
  const {progress, title} = screenOf(scanning({}));
  assert.equal(progress.text, 'Capturing, stop 10 of 36');
  assert.equal(progress.left, 'about 45 s left');
  assert.equal(progress.percent, 24);
  assert.equal(title, '9/36 · Octurn');
  assert.deepEqual(progress.steps.map(({state}) => state), ['done', 'now', 'next']);
});

test('a scan that was asked to stop says so at once', () => {
  const {progress} = screenOf(states.withStopping(scanning({}), running.id));
  assert.deepEqual([progress.text, progress.isStopping], ['Stopping…', true]);
  assert.ok(!screenOf(scanning({})).progress.isStopping);
});

test('the last stop is not the end: the model is still to be built', () => {
  const {progress, title} = screenOf(scanning({phase: 'building', snapshots_done: 36, seconds_left: null}));
  assert.equal(progress.text, 'Building the model');
  assert.ok(progress.percent < 100);
  assert.equal(title, 'Building · Octurn');
});

test('of a scan that is later than expected the time so far is told, and no end', () => {
  const {left, time} = screenOf(scanning({phase: 'calibrating', snapshots_done: 36, seconds_left: 0})).progress;
  assert.deepEqual([left, time], ['', '0:12']);
});

test('after the last snapshot the scanner looks once more at the first stop', () => {
  assert.equal(screenOf(scanning({phase: 'turning', snapshots_done: 36})).progress.text, 'Checking the first stop again');
});

test('what was left out of a model is told, but for crumbs', () => {
  const leftOut = (dropped_parts, dropped_volume_cm3) => {
    const scan = {...finished, model: {...finished.model, dropped_parts, dropped_volume_cm3}};
    return screenOf(looking(scan)).details.facts.find(({label}) => label === 'Left out')?.text;
  };
  assert.equal(leftOut(2, 1.25), '2 parts, 1.3 cm³');
  assert.equal(leftOut(70, 0.05), undefined);
  assert.equal(leftOut(0, 0), undefined);
  assert.equal(leftOut(null, null), undefined);
});

test('a finished scan shows its size, its facts and its download', () => {
  const {details, stage, title} = screenOf(looking(finished));
  assert.equal(details.name, 'Owl');
  assert.equal(details.size, '120.1 × 94.9 × 151.0 mm');
  const facts = Object.fromEntries(details.facts.map(({label, text}) => [label, text]));
  assert.equal(facts.Triangles, '1,011,032');
  assert.equal(facts.Volume, '97.1 cm³');
  assert.equal(facts['Sizes right within'], undefined, 'of an earlier version');
  assert.equal(facts.Watertight, 'Yes');
  assert.equal(facts.Snapshots, '36 of 36, average of 10');
  assert.deepEqual(details.download, {url: finished.model.url, about: '51 MB'});
  assert.equal(stage.shows, 'model');
  assert.equal(title, 'Owl · Octurn');
});

test('a finished scan tells first within what its sizes are right, and what would tell them better', () => {
  const told = (mm) => {
    const quality = {verdict: 'good', reasons: [], size_error: {mm, of_mm: 150.98}};
    return screenOf(looking({...finished, model: {...finished.model, quality}})).details.facts[0];
  };
  assert.deepEqual(told(0.6234), {label: 'Sizes right within', text: '±0.6 mm in 151 mm'});
  assert.equal(told(3.03).text, '±3.0 mm in 151 mm; a printed board or a known length lowers this');
});

test('a model with open edges is not called ready', () => {
  const open = {...finished, model: {...finished.model, watertight: false}};
  const fact = screenOf(looking(open)).details.facts.find(({label}) => label === 'Watertight');
  assert.equal(fact.tone, 'warn');
  assert.match(fact.text, /^No/);
});

test('a scan without a model says why, and what of it is kept', () => {
  const error = {code: 'sensor-silent', detail: 'no frame for 2000 ms', hint: 'Check the cable'};
  const failed = {...running, id: 'bad', state: 'failed', error};
  const {details, rows, stage} = screenOf(looking(failed));
  assert.deepEqual(details.trouble, {tone: 'bad', title: 'Scan failed', detail: 'No frame for 2000 ms.', hint: 'Check the cable.', action: null});
  assert.deepEqual([details.download, details.unbuilt.about], [null, 'of 9 snapshots, 1 mm']);
  assert.equal(details.canResume, false);
  assert.equal(rows[0].about, '9 of 36 snapshots kept');
  assert.equal(stage.shows, 'camera');
});

test('while the scanner is away the page keeps what it knew, and says so', () => {
  const {isAway, title, panel, stage, devices, progress} = screenOf(states.withoutAnswer(states.withoutAnswer(scanning({}))));
  assert.deepEqual({isAway, title, panel, isLive: stage.isLive}, {isAway: true, title: 'No answer · Octurn', panel: 'progress', isLive: false});
  assert.deepEqual(devices.map(({tone, text}) => `${tone} ${text}`), ['idle unknown', 'idle unknown']);
  assert.deepEqual([progress.isStale, progress.left], [true, '']);
});

test('a missing sensor is told before a scan is tried, and none can be started', () => {
  const sensor = {state: 'missing', name: '', simulated: false, message: 'no sensor: is it plugged in?'};
  const {faults, devices, stage, canStart} = screenOf(states.withStatus(states.initial, {...status, sensor}));
  assert.deepEqual(faults, ['No sensor: is it plugged in?']);
  assert.equal(canStart, false);
  assert.ok(screenOf(idle).canStart);
  assert.deepEqual(devices.map(({tone}) => tone), ['bad', 'good']);
  assert.equal(stage.isLive, false);
});

test('progress is announced four times a turn, not at each stop', () => {
  const said = Array.from({length: 37}, (_, done) => screenOf(scanning({snapshots_done: done})).announcement);
  assert.equal(new Set(said).size, 5);
  assert.equal(said[9], '25 percent of the snapshots taken.');
});

test('a paused scan says why, and can be resumed or ended', () => {
  const error = {code: 'sensor-lost', detail: 'the Kinect is gone', hint: 'Plug it in. Then resume the scan.'};
  const {details, rows, title, announcement, panel} = screenOf(looking({...running, id: 'wait', state: 'paused', phase: 'done', error}));
  assert.deepEqual(details.trouble, {tone: 'warn', title: 'Scan paused', detail: 'The Kinect is gone.', hint: 'Plug it in. Then resume the scan.', action: null});
  assert.equal(details.canResume, true);
  assert.equal(details.download, null);
  assert.deepEqual(rows[0].badge, {tone: 'warn', text: 'Paused'});
  assert.equal(rows[0].isRunning, false);
  assert.deepEqual({title, announcement, panel}, {title: `${rows[0].name} · Octurn`, announcement: 'Scan paused.', panel: 'details'});
});

test('an interrupted scan can be resumed, a finished, failed or cancelled one cannot', () => {
  const can = ['interrupted', 'finished', 'failed', 'cancelled'].map((state) => screenOf(looking({...running, state})).details.canResume);
  assert.deepEqual(can, [true, false, false, false]);
});

test('a scan that ended without a model still gives that of its snapshots, if it has any to make one of', () => {
  const unbuilt = (changes) => screenOf(looking({...running, id: 'end', state: 'cancelled', ...changes})).details.unbuilt;
  assert.deepEqual([unbuilt({}).about, unbuilt({}).isBusy], ['of 9 snapshots, 1 mm', false]);
  assert.equal(unbuilt({snapshots_done: 0}), null);
  assert.equal(unbuilt({state: 'failed', error: {code: 'empty', detail: '', hint: ''}}), null);
});

test('a model that did not fit into the memory is offered with larger leaves', () => {
  const failed = {...running, id: 'big', state: 'failed', error: {code: 'memory-limit', detail: '', hint: ''}};
  assert.deepEqual(screenOf(looking(failed)).details.unbuilt.settings, {leaf_size_mm: 2, choose: true});
});

test('a model cannot be asked for while a scan runs, and its offer says so', () => {
  const state = states.withSelected(states.withScan(scanning({}), {...running, id: 'end', state: 'cancelled'}), 'end');
  assert.equal(screenOf(state).details.unbuilt.isBusy, true);
});

test('a finished scan is downloaded in the formats that the scanner has, and as it was taken, one without a model only so', () => {
  const names = (scan) => screenOf(looking(scan)).details.formats.map(({url}) => url.split('/').at(-1));
  assert.deepEqual(names(finished), ['Scan.3mf', 'Scan.ply', 'Scan.glb', 'Scan.obj', 'scan.zip']);
  assert.deepEqual(names({...running, state: 'cancelled'}), ['scan.zip']);
});

test('a scan whose pictures have colours is downloaded with them, too, but as STL', () => {
  const {details, stage} = screenOf(looking({...finished, has_colours: true}));
  const coloured = details.formats.filter(({url}) => url.includes('colour'));
  assert.deepEqual(coloured.map(({url}) => url.split('/').at(-1)), ['3mf', 'ply', 'glb', 'obj'].map((ending) => `Scan.${ending}?colour=true`));
  assert.equal(coloured[1].name, 'PLY in colour');
  assert.equal(new Set(details.formats.map(({name}) => name)).size, details.formats.length);
  assert.equal(stage.paint, 'colours');
});

test('a model is painted by its views only if its scan has depth images', () => {
  const paintOf = (has_views) => screenOf(looking({...finished, has_views})).stage.paint;
  assert.deepEqual([true, false].map(paintOf), ['views', null]);
});

test('a build that is looked at is downloaded in all formats, and not the scan\'s own model', () => {
  const url = '/api/v1/scans/done/builds/2/Scan.stl';
  const {formats} = screenOf(looking({...finished, model: {...finished.model, url}})).details;
  assert.deepEqual(formats.slice(0, 4).map((format) => format.url), ['3mf', 'ply', 'glb', 'obj'].map((ending) => url.replace(/stl$/, ending)));
});

test('a scan has one name, in its row, its heading and the title', () => {
  const {rows, details, title} = screenOf(looking({...finished, name: ''}));
  assert.equal(rows[0].name, details.name);
  assert.equal(title, `${details.name} · Octurn`);
  assert.match(details.name, /2026/);
});

test('while a device is tried again the progress says which, and at what stop', () => {
  const error = {code: 'sensor-silent', detail: 'no frame for 2000 ms', hint: ''};
  const {progress} = screenOf(scanning({error, seconds_until_pause: 20.3}));
  assert.equal(progress.text, 'Trying stop 10 of 36 again');
  assert.equal(progress.trouble, 'No frame for 2000 ms.');
  assert.equal(progress.left, 'pauses in 21 s');
  assert.equal(screenOf(scanning({error})).announcement, 'Trying stop 10 of 36 again.');
  assert.equal(screenOf(scanning({})).progress.trouble, '');
});

test('late pulses of the motor are told, if there were any', () => {
  const motor = (late_pulses) => screenOf(looking({...finished, late_pulses})).details.facts.find(({label}) => label === 'Motor');
  assert.equal(motor(0), undefined);
  assert.match(motor(1234).text, /^1,234 pulses late/);
});

test('lost steps of the motor are told, if there were any', () => {
  const motor = (slips) => screenOf(looking({...finished, slips})).details.facts.find(({label}) => label === 'Motor');
  assert.equal(motor(0), undefined);
  assert.match(motor(1).text, /^lost steps at 1 stop,/);
  assert.match(motor(3).text, /^lost steps at 3 stops,/);
});

test('a platform that swung on is told, if stops waited for it', () => {
  const platform = (seconds_settling) => screenOf(looking({...finished, seconds_settling})).details.facts.find(({label}) => label === 'Platform');
  assert.equal(platform(0), undefined);
  assert.match(platform(0.8).text, /up to 0.8 s longer/);
});

test('a model is judged where it is shown and where it is listed', () => {
  const quality = {verdict: 'bad', reasons: [{code: 'stops-disagree', detail: 'the stops disagree by 4.2 mm', hint: 'calibrate the rig'}]};
  const {details, rows, announcement} = screenOf(looking({...finished, model: {...finished.model, quality}}));
  assert.deepEqual(details.verdict.reasons.map(({detail, hint, action}) => [detail, hint, action.href]),
      [['The stops disagree by 4.2 mm.', 'Calibrate the rig.', '#calibrate']]);
  assert.deepEqual(rows[0].badge, {tone: 'bad', text: 'Not good'});
  assert.equal(announcement, 'The model of Owl is ready. Not ready to print.');
});

test('a model that was never judged is finished, and no more', () => {
  const {details, rows} = screenOf(looking(finished));
  assert.equal(details.verdict, null);
  assert.deepEqual(rows[0].badge, {tone: 'good', text: 'Finished'});
});

test('a scan without a model leads to what cures it, too', () => {
  const error = {code: 'empty', detail: 'nothing was seen', hint: ''};
  assert.equal(screenOf(looking({...running, state: 'failed', error})).details.trouble.action.href, '#');
});

test('solving the pose and building again are told, after the turn', () => {
  for (const [phase, text] of [['calibrating', 'Checking where the sensor stands'], ['rebuilding', 'Building again, with the pose corrected']]) {
    const {progress, title} = screenOf(scanning({phase, snapshots_done: 36}));
    assert.equal(progress.text, text);
    assert.deepEqual(progress.steps.map(({state}) => state), ['done', 'done', 'now']);
    assert.equal(title, 'Building · Octurn');
  }
});

test('a scan says what became of the pose', () => {
  const pose = (calibration) => screenOf(looking({...finished, calibration})).details.facts.find(({label}) => label === 'Pose')?.text;
  assert.equal(pose(null), undefined);
  assert.equal(pose({accepted: true, reason: '', solved: {after_mm: 0.517}}), 'Corrected by this scan; views agree to 0.52 mm');
  assert.equal(pose({accepted: true, confirms_told: true, reason: '', solved: {after_mm: 0.517}}),
      'Confirmed by this scan; views agree to 0.52 mm');
  assert.equal(pose({accepted: false, reason: 'two stops are too few', solved: null}), 'Unchanged: two stops are too few');
});
