import assert from 'node:assert/strict';
import {test} from 'node:test';

import {complaintOf, phaseOf, shownOf} from '../../web/scanner/update.js';

const idle = {
  update: {version: '0.1.0', slot: 'a', state: 'none', update_version: '', error: ''},
  sending: null, isScanning: false, isAway: false, isFollowed: false, failure: '',
};

/** The page's state for an update as the scanner reports it, and further known state. */
const when = (update, known = {}) => ({...idle, update: {...idle.update, ...update}, ...known});

test('at rest the page tells what runs, and nothing of an update of long ago', () => {
  for (const state of ['none', 'kept']) {
    const {phase, summary, outcome} = shownOf(when({state, update_version: '0.1.0'}));
    assert.deepEqual({phase, summary, outcome}, {phase: null, summary: 'Octurn 0.1.0 is in use.', outcome: null});
  }
});

test('an update goes through its four steps', () => {
  const states = (state) => shownOf(state).steps.map((step) => step.state).join(' ');
  assert.equal(states(when({}, {sending: {sent: 1, total: 4}})), 'now next next next');
  assert.equal(states(when({state: 'receiving'})), 'now next next next');
  assert.equal(states(when({state: 'installing'})), 'done now next next');
  assert.equal(states(when({state: 'restarting'})), 'done done now next');
  assert.equal(states(when({state: 'trial'})), 'done done done now');
});

test('what is sent is told in bytes, and as a share', () => {
  const {text, progress, summary} = shownOf(when({state: 'failed'}, {sending: {sent: 11e6, total: 55e6}}));
  assert.deepEqual({text, progress, summary}, {text: '11 MB of 55 MB', progress: 0.2, summary: 'Sending the file…'});
  assert.equal(shownOf(when({state: 'installing'})).progress, null);
});

test('a scanner that goes away while it installs is starting again', () => {
  assert.equal(phaseOf(when({state: 'installing'}, {isAway: true, isFollowed: true})), 'restarting');
  assert.equal(phaseOf(when({state: 'installing'}, {isFollowed: true})), 'installing');
  assert.equal(phaseOf(when({state: 'none'}, {isAway: true, isFollowed: true})), null);
});

test('who saw an update coming is told how it ended', () => {
  const outcome = (update) => shownOf(when(update, {isFollowed: true})).outcome;
  assert.deepEqual(outcome({state: 'kept', update_version: '0.2.0'}), {tone: 'good', title: 'Octurn 0.2.0 is running', detail: ''});
  assert.deepEqual(outcome({state: 'failed', error: 'it is not signed'}),
      {tone: 'bad', title: 'The update was not installed', detail: 'It is not signed. Nothing was changed.'});
});

test('an update that was taken back is told to everybody', () => {
  const {tone, title} = shownOf(when({state: 'returned', update_version: '0.2.0'})).outcome;
  assert.deepEqual({tone, title}, {tone: 'warn', title: 'The update to 0.2.0 did not start; the earlier version is back'});
});

test('a file that was not taken says why, whatever became of the update before it', () => {
  const {tone, detail} = shownOf(when({state: 'returned'}, {failure: 'A scan is running.'})).outcome;
  assert.deepEqual({tone, detail}, {tone: 'bad', detail: 'A scan is running.'});
});

test('files that can be no update are not sent', () => {
  assert.equal(complaintOf(55e6), '');
  assert.equal(complaintOf(160 * 2 ** 20), '');
  assert.match(complaintOf(160 * 2 ** 20 + 1), /no update/);
  assert.match(complaintOf(0), /empty/);
});
