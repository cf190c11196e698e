import assert from 'node:assert/strict';
import {test} from 'node:test';

import {placeOf, tabOf, titleAt} from '../../web/places.js';

test('an address names a part of the page, or else a scan', () => {
  assert.deepEqual(['', 'calibrate', '20261121-081500-3f2a', 'toString'].map(placeOf), ['scan', 'calibrate', 'scan', 'scan']);
});

test('an address belongs to one of three places, that of a scan to the library', () => {
  assert.deepEqual(['', 'library', '20261121-081500-3f2a', 'scanner', 'calibrate', 'settings'].map(tabOf),
      ['scan', 'library', 'library', 'scanner', 'scanner', 'scanner']);
});

test('each part has its title', () => {
  assert.equal(titleAt('calibrate', '3/36 · Octurn'), 'Calibrate · Octurn');
  assert.equal(titleAt('scan', '3/36 · Octurn'), '3/36 · Octurn');
});
