import assert from 'node:assert/strict';
import {test} from 'node:test';

import {found, initial, knownTags, pictureOf, tagsIn, withAll, withToggled} from '../../web/library/library.js';
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

test('all that are found are chosen at once, and none the second time', () => {
  const some = withToggled({...initial, chosen: []}, 'a');
  assert.deepEqual(withAll(some, ['a', 'b']).chosen, ['a', 'b']);
  assert.deepEqual(withAll(withAll(some, ['a', 'b']), ['a', 'b']).chosen, []);
});

test('scans are found by their tags and numbers, and tags are written with commas between them', () => {
  const tagged = [{...finished, id: 'a', tags: ['Grab 10', 'Gefäß'], inventory_number: '2026.17'}, {...finished, id: 'b', tags: ['Grab 9', 'Gefäß']}];
  const idsOf = (query) => found(tagged, {...initial, query}, ({name}) => name).map(({id}) => id).join('');
  assert.deepEqual(['gefaß', 'grab 10', '2026.17'].map(idsOf), ['ab', 'a', 'a']);
  assert.deepEqual(knownTags(tagged), ['Gefäß', 'Grab 9', 'Grab 10']);
  assert.deepEqual(tagsIn(' Grab 9,,Gefäß , Grab 9'), ['Grab 9', 'Gefäß']);
});

test('another model of a scan has another picture, and a scan without one has none', () => {
  assert.notEqual(pictureOf(finished), pictureOf({...finished, build: 2}));
  assert.equal(pictureOf(running), '');
});
