import assert from 'node:assert/strict';
import {readFile, readdir} from 'node:fs/promises';
import {test} from 'node:test';

const folder = new URL('../../web/', import.meta.url);

// The pieces of the page that are fetched later stand in one document with the others.
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
