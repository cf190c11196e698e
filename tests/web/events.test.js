import assert from 'node:assert/strict';
import {test} from 'node:test';

import {HeardStatus} from '../../web/base/events.js';
import {status} from './examples.js';

test('what was told counts until the scanner falls silent', () => {
  const heard = new HeardStatus();
  assert.equal(heard.at(0), null);
  heard.hear(status, 0);
  assert.equal(heard.at(5000), status);
  assert.equal(heard.at(5001), null);
  heard.hearBeat(6000);
  assert.equal(heard.at(11000), status);
  heard.forget();
  assert.equal(heard.at(11000), null);
});

test('what may be from before an answer does not count', () => {
  const heard = new HeardStatus();
  heard.hear(status, 0);
  heard.distrust(100);
  assert.equal(heard.at(100), null);
  heard.hear(status, 1099);
  assert.equal(heard.at(1099), null);
  heard.hear(status, 1100);
  assert.equal(heard.at(1100), status);
});
