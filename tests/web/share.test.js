import assert from 'node:assert/strict';
import {test} from 'node:test';

import {isLocal, slicerLinks} from '../../web/scan/share.js';

const model = 'http://octurn.local/api/v1/scans/20261121-081500-3f2a/builds/2/Scan.3mf';

test('a slicer finds the whole address of the model after the last = or //', () => {
  for (const isMac of [false, true]) {
    for (const {href} of slicerLinks(model, isMac)) {
      assert.equal(decodeURIComponent(/[^=/]*$/.exec(href)[0]), model, href);
    }
  }
  const schemes = (isMac) => slicerLinks(model, isMac).map(({href}) => href.split(':')[0]);
  assert.deepEqual(schemes(false), ['orcaslicer', 'bambustudio', 'cura']);
  assert.deepEqual(schemes(true), ['orcaslicer', 'bambustudioopen', 'cura']);
});

test('an address of this computer is no address for a phone', () => {
  assert.ok(['localhost', '127.0.0.1', '[::1]'].every(isLocal));
  assert.ok(!['octurn.local', '192.168.1.127', '12.7.0.1', '[fe80::1]'].some(isLocal));
});
