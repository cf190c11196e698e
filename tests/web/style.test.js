import assert from 'node:assert/strict';
import {readdir, readFile} from 'node:fs/promises';
import {test} from 'node:test';

const page = new URL('../../web/', import.meta.url);
const style = await readFile(new URL('style.css', page), 'utf8');

/** The custom colour properties of both schemes. */
const pairs = [...style.matchAll(/--([a-z-]+): light-dark\((#[0-9a-f]{6}), (#[0-9a-f]{6})\);/g)];
const schemes = {
  light: Object.fromEntries(pairs.map(([, name, light]) => [name, light])),
  dark: Object.fromEntries(pairs.map(([, name, , dark]) => [name, dark])),
};

/** Relative luminance (WCAG 2.2). @param {string} colour */
function luminanceOf(colour) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255)
      .map((value) => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** @param {string} one @param {string} other */
function contrast(one, other) {
  const [bright, dim] = [luminanceOf(one), luminanceOf(other)].sort((a, b) => b - a);
  return (bright + 0.05) / (dim + 0.05);
}

const texts = [
  ...['ink', 'muted', 'accent', 'bad'].flatMap((text) => ['ground', 'card', 'sunken'].map((ground) => [text, ground])),
  ['on-accent', 'accent'], ['accent', 'accent-soft'], ['ink', 'accent-soft'],
  ['good', 'good-soft'], ['warn', 'warn-soft'], ['bad', 'bad-soft'], ['muted', 'idle-soft'], ['ink', 'warn-soft'], ['muted', 'warn-soft'],
];

for (const [scheme, colours] of Object.entries(schemes)) {
  test(`texts can be read in the ${scheme} colours`, () => {
    for (const [text, ground] of texts) {
      assert.ok(contrast(colours[text], colours[ground]) >= 4.5, `${text} on ${ground}: ${contrast(colours[text], colours[ground]).toFixed(2)}`);
    }
  });

  test(`what marks a control can be seen in the ${scheme} colours: an unchosen choice, a tick of the dial`, () => {
    for (const ground of ['card', 'sunken', 'ground']) {
      assert.ok(contrast(colours['line-strong'], colours[ground]) >= 3, `on ${ground}: ${contrast(colours['line-strong'], colours[ground]).toFixed(2)}`);
    }
  });
}

test('texts follow the font size of the browser: no style gives one in pixels', async () => {
  const files = (await readdir(page)).filter((name) => name.endsWith('.css'));
  assert.ok(files.length > 5);
  for (const file of files) {
    const rules = await readFile(new URL(file, page), 'utf8');
    assert.doesNotMatch(rules, /font(-size)?:[^;}]*\dpx/, file);
  }
});

test('controls are drawn with the line that can be seen', async () => {
  const scan = await readFile(new URL('../../web/scan.css', import.meta.url), 'utf8');
  assert.match(style, /\.choice \{[^}]*border: 1px solid var\(--line-strong\)/);
  assert.match(style, /\.secondary, \.quiet \{ border-color: var\(--line-strong\)/);
  assert.match(scan, /\.ticks \{[^}]*stroke: var\(--line-strong\)/);
});
