import assert from 'node:assert/strict';
import {test} from 'node:test';

import {codePath, wifiCodeText} from '../../web/scanner/wifi_code.js';

test('the text of a code is what phones read', () => {
  assert.equal(wifiCodeText('Home', 'open sesame'), 'WIFI:T:WPA;S:Home;P:open sesame;;');
  assert.equal(wifiCodeText('Octurn-1A2B', ''), 'WIFI:T:nopass;S:Octurn-1A2B;;');
});

test('what means something in it has a backslash before it, once', () => {
  assert.equal(wifiCodeText('a;b,c:d"e\\f', '\\;;"'), String.raw`WIFI:T:WPA;S:a\;b\,c\:d\"e\\f;P:\\\;\;\";;`);
});

test('a code has an empty border of four modules, and a finder in three of its corners', () => {
  const {size, path} = codePath(wifiCodeText('Home', 'open sesame'));
  const dark = new Set([...path.matchAll(/M(\d+) (\d+)h1v1h-1z/g)].map(([, x, y]) => `${x} ${y}`));
  const isDark = (x, y) => dark.has(`${x} ${y}`);
  assert.ok([...dark].every((place) => place.split(' ').every((at) => at >= 4 && at < size - 4)));
  const rings = [1, 0, 1, 1, 1, 0, 1].map(Boolean);  // a row through the centre of a finder pattern
  const across = (left, top) => rings.map((_, index) => isDark(left + index, top + 3));
  assert.deepEqual([across(4, 4), across(size - 11, 4), across(4, size - 11)], [rings, rings, rings]);
});
