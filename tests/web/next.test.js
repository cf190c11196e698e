import assert from 'node:assert/strict';
import {test} from 'node:test';

import {nextName, nextScan} from '../../web/scan/next.js';
import {finished, settings} from './examples.js';

const next = (name, ...taken) => nextName(name, new Set([name, ...taken]));

test('the last number of a name is raised, with its zeros, until no scan has it', () => {
  assert.equal(next('Find 7'), 'Find 8');
  assert.equal(next('Find 7', 'Find 8', 'Find 9'), 'Find 10');
  assert.equal(next('F009'), 'F010');
  assert.equal(next('2026-99b'), '2026-100b');
  assert.equal(next('Owl'), 'Owl 2');
  assert.equal(next('Owl', 'Owl 2'), 'Owl 3');
  assert.equal(next('9007199254740993'), '9007199254740994', 'beyond the whole numbers of a double');
});

test('a name of a hundred characters has one of a hundred after it', () => {
  const long = 'ü'.repeat(100);
  assert.equal(next(long), `${'ü'.repeat(98)} 2`);
  assert.equal(next(`${'ü'.repeat(99)}9`), `${'ü'.repeat(98)}10`);
});

test('the next object has the settings and the label of the scan, but its own name, number, notes and pose', () => {
  const scan = {
    ...finished, name: 'Find 7', notes: 'broken', tags: ['Grave 3'], inventory_number: '17', author: 'Jane Doe', licence: 'CC0 1.0',
    settings: {...settings, parts: 'all', platform_from_sensor: [[1]], depth_scale: 1.01},
  };
  assert.deepEqual(nextScan(scan, [scan]),
      {...settings, parts: 'all', name: 'Find 8', tags: ['Grave 3'], author: 'Jane Doe', licence: 'CC0 1.0'});
  assert.equal(nextScan({...scan, name: ''}, [scan]).name, 'Object 2');
});
