import assert from 'node:assert/strict';
import {test} from 'node:test';

import {found, initial, pictureOf, withToggled} from '../../web/library/library.js';
import {finished, running} from './examples.js';

const large = {...finished, model: {...finished.model, size_mm: [300, 300, 300]}};
const scans = [
  {...finished, id: 'c', name: 'Möwe 10'}, {...large, id: 'b', name: 'Hase'}, {...running, id: 'a', state: 'cancelled', name: 'Möwe 9'},
];
const ids = (changes) => found(scans, {...initial, ...changes}, ({name}) => name).map(({id}) => id).join('');

test('scans are found by any part of their names, whatever the accents and the order of words', () => {
  assert.equal(ids({query: 'mowe'}), 'ca');
  assert.equal(ids({query: '10 MÖW'}), 'c');
  assert.equal(ids({query: '2026 hase'}), 'b');
  assert.equal(ids({query: 'nothing'}), '');
});

test('scans are sorted by date, name with numbers in it, and size', () => {
  assert.deepEqual(['newest', 'oldest', 'name', 'largest'].map((order) => ids({order})), ['cba', 'abc', 'bac', 'bca']);
});

test('a thousand scans are searched and sorted in less than a picture of a film', () => {
  const many = Array.from({length: 1000}, (_, i) => ({...finished, id: String(i), name: `Scan ${(i * 7919) % 1000}`}));
  const begin = process.cpuUsage().user;
  found(many, {...initial, query: '1', order: 'name'}, ({name}) => name);
  assert.ok(process.cpuUsage().user - begin < 400_000, 'microseconds of this processor');
});

test('several are chosen one by one', () => {
  const both = withToggled(withToggled(initial, 'a'), 'b');
  assert.deepEqual(both.chosen, ['a', 'b']);
  assert.deepEqual(withToggled(both, 'a').chosen, ['b']);
});

test('another model of a scan has another picture, and a scan without one has none', () => {
  assert.notEqual(pictureOf(finished), pictureOf({...finished, build: 2}));
  assert.equal(pictureOf(running), '');
});
