import assert from 'node:assert/strict';
import {test} from 'node:test';

import {aboutKey} from '../../web/scanner/keys.js';

test('a key is told by what it allows', () => {
  const key = {id: '9f86d081', name: 'Home', access: 'read', created: '2026-11-24T08:15:00Z'};
  assert.match(aboutKey(key), /^May read · made .*2026/);
  assert.match(aboutKey({...key, access: 'full'}), /^May do everything but set passwords and keys · made /);
});
