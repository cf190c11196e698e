import assert from 'node:assert/strict';
import {test} from 'node:test';

import {forget, note, noted} from '../../web/base/storage.js';

test('without storage, as where a browser blocks it, a note holds until the page is closed', () => {
  assert.equal(noted('key'), null);
  note('key', 'value');
  assert.equal(noted('key'), 'value');
  forget('key');
  assert.equal(noted('key'), null);
});
