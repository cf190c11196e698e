import assert from 'node:assert/strict';
import {test} from 'node:test';

import {brighten, colour, colourOf} from '../../web/sensor/depth_picture.js';
import {ticks} from '../../web/scan/dial.js';

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

test('a picture that is exposed for lasers is brightened, until one pixel in a hundred is white', () => {
  const grey = (levels) => Uint8ClampedArray.from(levels.flatMap((level) => [level, level, level, 255]));
  const brightened = (levels) => {
    const pixels = grey(levels);
    brighten(pixels);
    return pixels;
  };
  assert.deepEqual(brightened([0, 20, 40, 51]), grey([0, 100, 200, 255]));
  const spot = [...Array(199).fill(51), 255];
  assert.deepEqual(brightened(spot), grey(Array(200).fill(255)));
  assert.deepEqual(brightened([0, 1, 2, 3]), grey([0, 24, 48, 72]), 'noise stays dark');
  assert.deepEqual(brightened([0, 0]), grey([0, 0]));
});
