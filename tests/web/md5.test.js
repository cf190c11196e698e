import assert from 'node:assert/strict';
import {createHash} from 'node:crypto';
import {test} from 'node:test';

import {md5} from '../../web/base/md5.js';

test('is the MD5 that others compute, of messages of all lengths', () => {
  assert.equal(md5(''), 'd41d8cd98f00b204e9800998ecf8427e');
  for (let length = 1; length < 200; ++length) {
    const message = Array.from({length}, (_, i) => String.fromCodePoint(32 + (i * i * 7 + length) % 600)).join('');
    assert.equal(md5(message), createHash('md5').update(message, 'utf8').digest('hex'), message);
  }
});
