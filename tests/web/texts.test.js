import assert from 'node:assert/strict';
import {readFile, readdir} from 'node:fs/promises';
import {test} from 'node:test';

import {languageOf, languages, localeOf, text, translated, typeset} from '../../web/base/texts.js';

const folder = new URL('../../web/', import.meta.url);
const files = new Map(await Promise.all(Object.keys(languages).map(async (language) =>
  /** @type {const} */ ([language, await import(`../../web/texts/${language}.js`)]))));
const english = files.get('en').texts;

/** The page's sources. Pages for programmers and build scripts exist in English only. */
const sources = (await readdir(folder, {recursive: true})).filter((name) => /\.(js|html)$/.test(name) &&
  !/^(texts\/|help\/|(bundle|interface|openapi|render_help|three|uqr)\.)/.test(name));
const written = new Map(await Promise.all(sources.map(async (name) =>
  /** @type {const} */ ([name, await readFile(new URL(name, folder), 'utf8')]))));

/** Text keys used in a file: whole ones, and prefixes of keys that it composes. */
function namedIn(source) {
  const whole = [...source.matchAll(/data-text(?:-label|-title|-placeholder)?="([^"]+)"/g)].map(([, key]) => key);
  const quoted = [...source.matchAll(/'([a-z][a-z-]*(?:\.[a-z0-9_-]+)*)'/g)].map(([, key]) => key).filter((key) => key in english);
  const begun = [...source.matchAll(/(?:text|isText)\(`([a-z.-]+)\$\{/g)].map(([, key]) => key);
  const asked = [...source.matchAll(/\btext\('([^']+)'/g)].map(([, key]) => key);
  return {whole: [...whole, ...asked], quoted, begun};
}

const named = [...written.values()].map(namedIn);

test('every key that the page names has a text', () => {
  const keys = new Set(named.flatMap(({whole}) => whole));
  assert.deepEqual([...keys].filter((key) => !(key in english)), []);
  assert.ok(keys.size > 300, `${keys.size} keys`);
  for (const begun of new Set(named.flatMap((file) => file.begun))) {
    assert.ok(Object.keys(english).some((key) => key.startsWith(begun)), begun);
  }
});

test('no text is left that nobody shows', () => {
  const keys = new Set(named.flatMap(({whole, quoted}) => [...whole, ...quoted]));
  const begun = named.flatMap((file) => file.begun);
  assert.deepEqual(Object.keys(english).filter((key) => !keys.has(key) && !begun.some((beginning) => key.startsWith(beginning))), []);
});

const placesIn = (text) => [...text.matchAll(/\{(\w+)\}/g)].map(([, name]) => name).sort();

for (const [language, {texts, said}] of files) {
  test(`${languages[language]} has every text, in every form, with the same values`, () => {
    assert.deepEqual(Object.keys(texts).filter((key) => !(key in english)), []);
    const forms = new Intl.PluralRules(language).resolvedOptions().pluralCategories.filter((form) => form !== 'many');
    for (const [key, original] of Object.entries(english)) {
      const text = texts[key];
      if (typeof original === 'string') {
        assert.equal(typeof text, 'string', key);
        assert.ok(text.trim() !== '', key);
        assert.deepEqual(placesIn(text), placesIn(original), key);
      } else {
        assert.deepEqual(Object.keys(text).sort(), [...forms].sort(), key);
        Object.values(text).forEach((form) => assert.deepEqual(placesIn(form), placesIn(original.other), key));
      }
    }
  });

  test(`${languages[language]} keeps every value of the scanner's sentences`, () => {
    for (const [original, translation] of Object.entries(said)) {
      const values = original.split('{}').length - 1;
      const used = [...translation.matchAll(/\{(\d?)\}/g)];
      assert.equal(used.length, values, original);
      assert.ok(used.every(([, place]) => Number(place) <= values), original);
      assert.doesNotMatch(original, /\d/, `its numbers are written as {}: ${original}`);
    }
  });
}

/** All texts that the scanner may send: the string literals of its sources, with parts of a sentence joined. */
async function scannersWords() {
  const source = new URL(`file://${process.env.OCTURN_SOURCE}/`);
  const files = (await Promise.all(['core/src/', 'firmware-app/'].map(async (path) =>
    (await readdir(new URL(path, source), {recursive: true})).map((name) => new URL(path + name, source))))).flat();
  const code = await Promise.all(files.filter(({pathname}) => /\.[ch]pp$/.test(pathname)).map((file) => readFile(file, 'utf8')));
  return code.join('\n').replace(/"\s*\n\s*"/g, '').replace(/%\.?\d*[a-z]+/g, '{}');
}

test('each sentence that has a translation is one of the scanner', async () => {
  const words = await scannersWords();
  const pairsOf = (sentence) => sentence.split(/\{\}|[:;,.]/).flatMap((part) => {
    const one = part.trim().split(' ');
    return one.slice(1).map((word, index) => `${one[index]} ${word}`);
  });
  for (const sentence of Object.keys(files.get('de').said)) {
    const unknown = pairsOf(sentence).filter((pair) => !words.includes(pair));
    assert.ok(unknown.length <= 3, `${sentence}: ${unknown}`);  // where the scanner composes sentences
  }
});

test('whatever the check advises has a translation', async () => {
  const folder = new URL(`file://${process.env.OCTURN_SOURCE}/firmware-app/src/`);
  const doctor = (await readdir(new URL('doctor/', folder))).filter((name) => name.endsWith('.cpp'));
  const names = [...doctor.map((name) => `doctor/${name}`), 'turntable/gpio_lines.cpp'];
  const code = await Promise.all(names.map((name) => readFile(new URL(name, folder), 'utf8')));
  const joined = code.join('\n').replace(/"\s*\n\s*"/g, '');
  const literals = [...joined.matchAll(/"((?:[^"\\\n]|\\.)*)"/g)].map(([, words]) => words);
  const advice = literals.filter((words) => /^[A-Z][a-z]+ .*\.$/.test(words))
      .map((words) => words.replace(/-?\d+(?:\.\d+)?/g, '{}'));
  assert.ok(advice.length > 40, `${advice.length} sentences`);
  assert.deepEqual(advice.filter((words) => !Object.hasOwn(files.get('de').said, words)), []);
});

test('what the check says of a camera and its lasers has a translation', () => {
  for (const lasers of ['left and right', 'left', 'right']) {
    assert.ok(Object.hasOwn(files.get('de').said, `{}, {} x {}, sees laser ${lasers}`), lasers);
  }
});

test('German, French and Spanish are not English', () => {
  const wordy = Object.entries(english).filter(([, text]) => typeof text === 'string' && /[a-z]{3,} [a-z]{3,}/.test(text));
  assert.ok(wordy.length > 150);
  for (const [language, {texts, said}] of files) {
    const translations = Object.keys(files.get('de').said).sort();
    if (language === 'en') {
      assert.deepEqual(Object.keys(said).filter((sentence) => !translations.includes(sentence)), []);
    } else {
      assert.deepEqual(wordy.filter(([key, text]) => texts[key] === text).map(([key]) => key), [], language);
      assert.ok(Object.keys(said).length > 100, language);
      assert.deepEqual(Object.keys(said).sort(), translations, language);
    }
  }
});

test('no word of the page stands outside the texts', () => {
  const names = /^(Octurn|·|mm|°|[−+]?\d*°?|−|\+)$/;
  for (const [name, source] of written) {
    if (name.endsWith('.html')) {
      const body = source.slice(Math.max(source.indexOf('<body>'), 0)).replace(/<noscript>.*?<\/noscript>/gs, '');
      const words = [...body.matchAll(/>([^<>]*)</g)].map(([, text]) => text.trim()).filter((text) => text !== '' && !names.test(text));
      assert.deepEqual(words, [], name);
      assert.doesNotMatch(body, /\s(?:aria-label|title)="[^"]*[a-z]/, name);
    } else {
      const code = source.replace(/\/\*.*?\*\//gs, '').replace(/(^|\s)\/\/ .*$/gm, '');
      assert.doesNotMatch(code, /['`][A-Z][a-z]+ [a-z][^'`]*['`]/, name);
    }
  }
});

test('no source has a lookbehind, with which Safari before 16.4 would read none of the page', () => {
  assert.deepEqual([...written].filter(([, source]) => /\(\?<[=!]/.test(source)).map(([name]) => name), []);
});

test('the language is the chosen one, or the first of the browser that the page knows', () => {
  assert.equal(languageOf(null, ['pt-BR', 'de-AT', 'en']), 'de');
  assert.equal(languageOf('fr', ['de']), 'fr');
  assert.equal(languageOf('xx', ['zh', 'ja']), 'en');
  assert.equal(languageOf('toString', []), 'en');
  assert.deepEqual([localeOf('de', ['en', 'de-AT']), localeOf('fr', ['en'])], ['de-AT', 'fr']);
});

test('a sentence that is not known stays as it is, whatever is in it', () => {
  for (const sentence of ['', '640 x 480', '0.02, 0.03; 4', ', ', 'constructor', 'nobody has said this, 3 times; never']) {
    assert.equal(translated(sentence), sentence);
  }
});

test('a number and its unit stay on one line, in every language', () => {
  const units = /\d (?:mm|cm|cm³|m|ms|s|min|h|MB|%|V)(?![\p{L}\p{N}])/u;
  const parted = (words) => [...words].flatMap((sentence) => {
    const filled = sentence.replace(/\{\w*\}/g, '36');
    return units.test(typeset(filled)) ? [filled] : [];
  });
  for (const {texts, said} of files.values()) {
    const all = Object.values(texts).flatMap((one) => typeof one === 'string' ? [one] : Object.values(one));
    assert.deepEqual(parted([...all, ...Object.values(said)]), []);
  }
  assert.equal(typeset('36 mm · 5 min, 3 s; 0.5 s a stop, 640 x 480, 97 %, 12 parts, 4 mA, 7 hours'),
      '36\u00a0mm\u00a0· 5\u00a0min, 3\u00a0s; 0.5\u00a0s a stop, 640 × 480, 97%, 12 parts, 4 mA, 7 hours');
});

test('no sentence on the page asks for a shell or a file of settings', () => {
  const shell = /(?:^| )--[a-z]|sudo|_mb\b|octurn\.json|octurn (?:calibrate|set)/;
  for (const {said} of files.values()) {
    assert.deepEqual(Object.values(said).filter((words) => shell.test(words)), []);
  }
  const en = files.get('en')?.said ?? {};
  assert.deepEqual(Object.keys(files.get('de')?.said ?? {}).filter((key) => shell.test(key) && !Object.hasOwn(en, key)), []);
  assert.equal(translated('End other programs, or lower memory_limit_mb in octurn.json.'),
      'End other programs, or lower Memory in the settings.');
  for (const before of ['', 'sensor: ', 'no sensor was found: ']) {
    assert.equal(translated(`${before}kinect: none is plugged in`), 'no Kinect is plugged in');
  }
});

test('numbers in a text lose none of their digits', () => {
  assert.equal(text('settings.range', {minimum: 0.001, maximum: 1000}), 'It must be between 0.001 and 1000.');
  assert.equal(text('count.snapshots', {count: 1}), '1 snapshot');
  assert.equal(text('count.snapshots', {count: 0}), '0 snapshots');
});
