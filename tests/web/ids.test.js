import assert from 'node:assert/strict';
import {readFile, readdir} from 'node:fs/promises';
import {test} from 'node:test';

const folder = new URL('../../web/', import.meta.url);

// Fragments that are fetched later become part of the same document.
test('no two elements of the page have one id', async () => {
  const places = new Map();
  for (const file of (await readdir(folder)).filter((name) => name.endsWith('.html'))) {
    const text = await readFile(new URL(file, folder), 'utf8');
    for (const [, id] of text.matchAll(/\sid="([^"]+)"/g)) {
      assert.equal(places.get(id), undefined, `${id} is in ${file} and ${places.get(id)}`);
      places.set(id, file);
    }
  }
  assert.ok(places.size > 100, `${places.size} ids`);
});

/** Width and height of a PNG (third edition, 11.2.1); null for other files. @param {Buffer} file */
const sidesOf = (file) => file.subarray(1, 4).toString() === 'PNG' ? [file.readUInt32BE(16), file.readUInt32BE(20)] : null;

test('browsers and phones find the icons that the page names, in the sizes that it says', async () => {
  const {icons} = JSON.parse(await readFile(new URL('octurn.webmanifest', folder), 'utf8'));
  const index = await readFile(new URL('index.html', folder), 'utf8');
  const [, apple] = /rel="apple-touch-icon" href="([^"]+)"/.exec(index);
  const named = [...icons.filter(({type}) => type === 'image/png'), {src: apple, sizes: '180x180'}];
  assert.ok(named.length >= 2);
  for (const {src, sizes} of named) {
    assert.equal(sidesOf(await readFile(new URL(src, folder)))?.join('x'), sizes, src);
  }
  assert.ok((await readFile(new URL('favicon.ico', folder))).length > 0, 'browsers ask for it unasked');
});
