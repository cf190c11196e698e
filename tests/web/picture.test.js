import assert from 'node:assert/strict';
import {test} from 'node:test';

import {colour, colourOf} from '../../web/depth.js';
import {ticks} from '../../web/dial.js';

/** Relative luminance of sRGB (IEC 61966-2-1). */
function luminance(rgb) {
  const [r, g, b] = rgb.map((value) => value / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

test('nearer is always lighter, so that the colours also work without colour', () => {
  for (let brightness = 25; brightness < 256; ++brightness) {
    assert.ok(luminance(colourOf(brightness)) > luminance(colourOf(brightness - 1)), `${brightness}`);
  }
});

test('pixels without a reading become transparent, the others stay opaque', () => {
  const pixels = Uint8ClampedArray.of(0, 0, 0, 255, 24, 24, 24, 255, 255, 255, 255, 255);
  colour(pixels);
  assert.deepEqual([...pixels].filter((_, i) => i % 4 === 3), [0, 255, 255]);
  assert.deepEqual([...pixels.slice(8, 11)], colourOf(255));
});

test('ticks go around the dial once, clockwise from the top', () => {
  const starts = [...ticks(0, 4, 4).matchAll(/M([\d.]+) ([\d.]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);
  assert.deepEqual(starts, [[110, 22], [198, 110], [110, 198], [22, 110]]);
});

test('taken and missing ticks make the whole dial', () => {
  assert.equal(ticks(0, 3, 36) + ticks(3, 36, 36), ticks(0, 36, 36));
});
