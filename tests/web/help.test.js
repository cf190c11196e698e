import assert from 'node:assert/strict';
import {existsSync, readdirSync, readFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {test} from 'node:test';
import {fileURLToPath} from 'node:url';

const page = resolve(dirname(fileURLToPath(import.meta.url)), '../../web');
const folder = join(page, 'help');
const texts = new Map(readdirSync(folder).filter((file) => file.endsWith('.html'))
    .map((file) => [file, readFileSync(join(folder, file), 'utf8')]));

test('the guide and what it leads to are there, each with a title and in the list of all', () => {
  assert.ok(texts.size >= 9 && texts.has('guide.html') && texts.has('wiring.html') && texts.has('settings.html'));
  for (const [file, text] of texts) {
    assert.match(text, /<title>[^<]+ · Octurn<\/title>/, file);
    assert.equal([...text.matchAll(/<h1 /g)].length, 1, file);
    for (const other of texts.keys()) {
      assert.ok(text.includes(`<li><a href="${other}"`), `${file} lists ${other}`);
    }
  }
});

test('every link and picture leads to something that the scanner has', () => {
  for (const [file, text] of texts) {
    for (const [, address] of text.matchAll(/(?:href|src)="([^"]*)"/g)) {
      const [path, anchor] = address.split('#');
      if (/^https?:/.test(path)) {
        continue;
      }
      const target = path === '' ? join(folder, file) : resolve(folder, path);
      assert.ok(existsSync(target), `${file}: ${address}`);
      assert.ok(!anchor || readFileSync(target, 'utf8').includes(` id="${anchor}"`), `${file}: ${address}`);
    }
  }
});

test('the links of the page into the help are right', () => {
  for (const file of readdirSync(page).filter((name) => name.endsWith('.html'))) {
    for (const [, address] of readFileSync(join(page, file), 'utf8').matchAll(/href="(help\/[^"]*)"/g)) {
      assert.ok(existsSync(join(page, address.split('#')[0])), `${file}: ${address}`);
    }
  }
});

test('the wiring tells where the sensor stands, in the numbers of the settings: the check sends people there', () => {
  const [told] = [...texts.get('settings.html').matchAll(/([\d.]+) m before the axis, ([\d.]+) m up, (\d+) degrees down/g)];
  assert.ok(told, 'the settings tell it');
  const [, before, up, down] = told;
  for (const words of [`${before} m before`, `${up} m above`, `${down} degrees down`]) {
    assert.ok(texts.get('wiring.html').includes(words), words);
  }
});
