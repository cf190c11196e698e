import assert from 'node:assert/strict';
import {existsSync, readdirSync, readFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {test} from 'node:test';
import {fileURLToPath} from 'node:url';

import {languages} from '../../web/base/texts.js';

const page = resolve(dirname(fileURLToPath(import.meta.url)), '../../web');
const folder = join(page, 'help');
const texts = new Map(readdirSync(folder).filter((file) => file.endsWith('.html'))
    .map((file) => [file, readFileSync(join(folder, file), 'utf8')]));

test('the guide and what it leads to are there, each with a title and in the list of all', () => {
  for (const [file, ...needed] of [
    ['guide.html', 'hardware.html', 'wiring.html', 'settings.html', 'calibration.html', 'laser.html', 'first-day.html'],
    ['hardware.html', 'parts.html', 'drawing.svg', 'kinect.png', 'laser.png', 'drive.png'],
  ]) {
    for (const address of needed) {
      assert.ok(texts.get(file).includes(`"${address}`), `${file} leads to ${address}`);
    }
  }
  for (const [file, text] of texts) {
    assert.match(text, /<title>[^<]+ · Octurn<\/title>/, file);
    assert.equal([...text.matchAll(/<h1 /g)].length, 1, file);
    const language = /<html lang="(..)">/.exec(text)[1];
    for (const other of [...texts.keys()].filter((name) => !/\.\w\w\.html$/.test(name))) {
      const own = other.replace('.html', `.${language}.html`);
      assert.ok(text.includes(`<li><a href="${texts.has(own) ? own : other}"`), `${file} lists ${other}`);
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

/** The parts of a document that its translation has, too: headings and their anchors, steps, tables, code, links. */
const skeletonOf = (html) => {
  const main = html.slice(html.indexOf('<main>'), html.indexOf('</main>'));
  return {
    tags: [...main.matchAll(/<(h\d id="[^"]*"|ol|ul|li|table|tr|t[hd]|pre|blockquote|p)\b/g)].map(([, tag]) => tag),
    links: [...main.matchAll(/href="([^"]*)"/g)].map(([, address]) => address),
    code: [...main.matchAll(/<code>([^<]*)<\/code>/g)].map(([, code]) => code).filter((code) => !/[= ]/.test(code)),
  };
};

/** The page's own words in the guide, which are set in bold or italics. */
const marked = (html) => [...html.matchAll(/<(strong|em)>([^<]*)<\/\1>/g)]
    .map(([, , words]) => words.replace(/\s+/g, ' '));

for (const language of Object.keys(languages).filter((one) => one !== 'en')) {
  test(`the guide in ${languages[language]} has every step, link and command, and the page's words`, async () => {
    const [original, guide] = [texts.get('guide.html'), texts.get(`guide.${language}.html`)];
    assert.ok(guide.includes(`<html lang="${language}">`));
    const [all, own] = [original, guide].map(skeletonOf);
    assert.ok(all.tags.length > 100 && all.links.length > 5 && all.code.length > 20);
    assert.deepEqual(own, all);
    const [english, translated] = await Promise.all(['en', language].map((one) => import(`../../web/texts/${one}.js`)));
    const keys = Object.keys(english.texts);
    const used = marked(original).map((words) => keys.filter((key) => english.texts[key] === words))
        .filter(({length}) => length > 0);
    assert.ok(used.length > 20, `${used.length} words of the page`);
    for (const names of used) {
      const words = names.map((key) => translated.texts[key]);
      const isThere = words.some((word) => guide.replace(/\s+/g, ' ').includes(word));
      assert.ok(isThere, `${english.texts[names[0]]}: ${words}`);
    }
  });
}

test('the wiring tells where the sensor stands, in the numbers of the settings: the check sends people there', () => {
  const [told] = [...texts.get('settings.html').matchAll(/([\d.]+) m before the axis, ([\d.]+) m up, (\d+) degrees down/g)];
  assert.ok(told, 'the settings tell it');
  const [, before, up, down] = told;
  for (const words of [`${before} m before`, `${up} m above`, `${down} degrees down`]) {
    assert.ok(texts.get('wiring.html').includes(words), words);
  }
});
