import assert from 'node:assert/strict';
import {test} from 'node:test';

import {changeOf, isAnswered, nameComplaint} from '../../web/scanner/machine.js';

const machine = {name: 'octurn', time_zone: 'Etc/UTC', error: ''};

test('a name is one that a network takes', () => {
  for (const name of ['octurn', 'Shed-2', 'a', 'x'.repeat(63)]) {
    assert.equal(nameComplaint(name), '', name);
  }
  for (const name of ['', '-a', 'a-', 'my scanner', 'a.b', 'ä', 'x'.repeat(64)]) {
    assert.notEqual(nameComplaint(name), '', name);
  }
});

test('only what differs is asked for', () => {
  assert.deepEqual(changeOf(machine, 'Octurn', 'Etc/UTC'), {});
  assert.deepEqual(changeOf(machine, 'Shed-2', 'Europe/Berlin'), {name: 'shed-2', time_zone: 'Europe/Berlin'});
});

test('an answer is waited for until it is as wanted, or says why not', () => {
  assert.equal(isAnswered(machine, {name: 'shed'}), false);
  assert.equal(isAnswered({...machine, name: 'shed'}, {name: 'shed'}), true);
  assert.equal(isAnswered({...machine, error: 'no'}, {time_zone: 'Europe/Berlin'}), true);
});
