// The whole page in each language, on a phone, where long words have the least room.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {texts} from '../../web/texts/en.js';
import {badWords, overflow, parted} from './access.js';
import {awaitPlace, openBrowser, openPage, picture} from './browser.js';
import {ask, scan, startScanner} from './scanner.js';

const draft = {snapshots: 3, leaf_size_mm: 8, filter: 'basic'};

/** A pseudo-language without any letter of A to Z: a text that still shows one was never translated. */
const strange = (words) => words.replace(/\{\w+\}|[a-z]/gi, (part) => part.startsWith('{') ? part : 'ж');
const strangeTexts = Object.fromEntries(Object.entries(texts).map(([key, text]) => [key, typeof text === 'string' ? strange(text) :
  Object.fromEntries(Object.entries(text).map(([form, words]) => [form, strange(words)]))]));

/** Keys of the API whose values are texts for people. The page shows them as they are if it has no translation. */
const said = new Set(['detail', 'hint', 'message', 'measured', 'advice', 'name', 'error', 'reason', 'title', 'x-unit']);
const strangeAnswer = (value) => Array.isArray(value) ? value.map(strangeAnswer) : value === null || typeof value !== 'object' ? value :
  Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, said.has(key) && typeof inner === 'string' ? strange(inner) : strangeAnswer(inner)]));

/** Names, units, formats and other words that are the same in every language. */
const known = /Octurn|octurn|\b(mm|cm|cm³|m|s|min|h|ms|[kMG]?B|byte|STL|3MF|PLY|GLB|OBJ|AM|PM|UTC|Home Assistant|OctoPrint|Moonraker|PrusaLink|DRV8825|TMC2209|English|Deutsch|Español|Français|GPIO\d+|X|Y|Z)\b|\b[A-Z][a-z]{2} \d+, \d{4}|\d+e\d+|\d+\.\d+\.\d+~\S+|https?:\S+/g;

/** Every text that is visible or in an accessible name now and has a letter of A to Z. */
const lettersLeft = (page) => page.evaluate(() => {
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const {parentElement, textContent} = walker.currentNode;
    if (!parentElement.closest('[hidden], script, noscript, template, option[value*="/"], #countries') && textContent.trim()) {
      found.push(textContent.trim());
    }
  }
  for (const name of ['aria-label', 'title', 'placeholder', 'aria-valuetext']) {
    document.querySelectorAll(`body [${name}]`).forEach((element) => element.closest('[hidden]') || found.push(element.getAttribute(name)));
  }
  return found;
});

async function readStrangely(scanner, browser, finished) {
  const {page} = await openPage(browser, 'about:blank');
  await page.route(/\/en(-\w+)?\.js$/, (route) => route.fulfill({
    contentType: 'text/javascript', body: `export const said = {}; export const texts = ${JSON.stringify(strangeTexts)};`}));
  await page.route('**/api/v1/events', (route) => route.abort());
  await page.route(/\/api\/v1\/(?!events|preview|.*\.(stl|png))/, async (route) => {
    const response = await route.fetch().catch(() => null);
    const json = await response?.json().catch(() => null);
    return json ? route.fulfill({response, json: strangeAnswer(json)}) : response ? route.fulfill({response}) : route.abort();
  });
  const places = {
    scan: () => page.locator('#all-settings').evaluate((details) => { details.open = true; }),
    library: () => page.locator('#rows > li').first().waitFor(),
    scanner: async () => {
      await page.locator('#examine').click();
      await page.locator('.finding').first().waitFor();
    },
    calibrate: () => page.locator('#pose-no-picture').waitFor({state: 'hidden'}),
    settings: async () => {
      await page.locator('#cards').waitFor();
      await page.locator('#cards').evaluate((cards) => cards.querySelectorAll('details').forEach((details) => { details.open = true; }));
    },
    [finished.id]: () => page.locator('#build-again').evaluate((details) => { details.open = true; }),
  };
  for (const [place, reach] of Object.entries(places)) {
    await page.goto(`${scanner.url}#${place === 'scan' ? '' : place}`);
    await page.locator('#devices li').first().waitFor();
    await awaitPlace(page, place);
    await reach();
    const english = (await lettersLeft(page)).filter((text) => /[a-z]{2}/i.test(text.replace(known, '')));
    assert.deepEqual(english, [], place);
  }
  await page.unrouteAll({behavior: 'ignoreErrors'});  // a request may be pending
  await page.context().close();
}

/** Further states of the page, as functions that lead to each from the one before. */
const states = {
  renaming: async (page) => {
    await page.locator('#details-rename').click();
    await page.locator('dialog[open]').waitFor();
  },
  checked: async (page) => {
    await page.keyboard.press('Escape');
    await page.goto(`${new URL('/', page.url())}#scanner`);
    await page.locator('#examine').click();
    await page.locator('.finding').first().waitFor();
    assert.doesNotMatch(await page.locator('#findings').innerText(), /\b(the|of|where|with)\b/, 'English');
  },
  scanning: async (page, scanner) => {
    await page.goto(`${scanner.url}#`);
    await ask(scanner, 'scans', 'POST', {...draft, snapshots: 200});
    await page.locator('[data-panel=progress]').waitFor();
  },
  ended: async (page, scanner) => {
    const {scan: {id}} = await ask(scanner, 'status');
    await ask(scanner, `scans/${id}/cancel`, 'POST');
    await page.locator('#trouble').waitFor();
  },
};

/** Visits each place and state on a phone: nothing is cut off, and the texts are accessible. */
async function readOnPhone(scanner, browser, finished, locale) {
  const {page, faults} = await openPage(browser, scanner.url, {screen: 'phone', locale});
  assert.equal(await page.evaluate(() => document.documentElement.lang), locale.slice(0, 2));
  for (const place of ['', 'library', 'scanner', 'calibrate', 'settings', finished.id]) {
    await page.goto(`${scanner.url}#${place}`);
    await awaitPlace(page, place);
    await page.locator(place === 'settings' ? '#cards' : place === finished.id ? '#download' : 'main:not([hidden]) :is(h1, h2):visible').first().waitFor();
    await page.evaluate(() => document.querySelectorAll('main:not([hidden]) details').forEach((details) => { details.open = true; }));
    assert.ok(await overflow(page) <= 0, `${place} is ${await overflow(page)} pixels too wide in ${locale}`);
    assert.deepEqual(await badWords(page), [], `${place} in ${locale}`);
    assert.deepEqual(await parted(page), [], `${place} in ${locale}`);
    await picture(page, `${locale}-${place === finished.id ? 'result' : place || 'scan'}-phone`);
  }
  for (const [name, reach] of Object.entries(states)) {
    await reach(page, scanner);
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide in ${locale}`);
    assert.deepEqual(await badWords(page), [], `${name} in ${locale}`);
    assert.deepEqual(await parted(page), [], `${name} in ${locale}`);
    await picture(page, `${locale}-${name}-phone`);
  }
  assert.deepEqual(faults.filter((fault) => !fault.includes('WebGL')), []);  // this browser has no WebGL
  return page;
}

test('the page speaks the language of its reader', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t, {hasWebGl: false});
  const finished = await scan(scanner, draft);
  await t.test('no word of it is left in English where everything is translated', () => readStrangely(scanner, browser, finished));
  for (const locale of ['de-DE', 'fr-FR', 'es-ES']) {
    await t.test(`it fits on a phone in ${locale}, and is for everyone`, async () =>
      (await readOnPhone(scanner, browser, finished, locale)).context().close());
  }
  await t.test('the one that is chosen in the settings holds', async () => {
    const {page} = await openPage(browser, scanner.url, {locale: 'fr-FR'});
    await page.goto(`${scanner.url}#settings`);
    await page.getByRole('combobox', {name: 'Langue'}).selectOption('Deutsch');
    await page.getByRole('heading', {name: 'Einstellungen'}).waitFor();
    await page.reload();
    await page.getByRole('heading', {name: 'Einstellungen'}).waitFor();
    await page.getByRole('combobox', {name: 'Sprache'}).selectOption('Wie im Browser');
    await page.getByRole('heading', {name: 'Réglages'}).waitFor();
    await page.context().close();
  });
  await t.test('what the scanner refuses is told in it, with its values', async () => {
    const {page} = await openPage(browser, scanner.url, {locale: 'de-DE'});
    await page.route('**/api/v1/scans', (route) => route.request().method() === 'POST' ? route.fulfill({
      status: 503, contentType: 'application/problem+json',
      json: {code: 'sensor-silent', title: 'The sensor does not work', detail: 'sensor: no frame for 2500 ms', parameters: {silent_ms: 2500}, hint: 'Unplug the sensor, plug it in again, and retry.'},
    }) : route.continue());
    await page.getByRole('button', {name: 'Scan starten'}).click();
    const alert = page.getByRole('alert').filter({hasText: 'Der Scan hat nicht begonnen'});
    assert.match(await alert.innerText(), /Der Sensor hat seit 2\.500\sms kein Bild gesendet\.[^]*Den Sensor abziehen, wieder einstecken/);
    await page.context().close();
  });
  await t.test('and so is what it warns of', async () => {
    const {page} = await openPage(browser, 'about:blank', {locale: 'de-DE'});
    const warnings = [{check: 'clock', name: 'Clock', state: 'warning', measured: '2026-11-25 06:22 UTC, not from a time server', action: '',
      advice: 'Connect the scanner to a network with internet, or its scans have wrong dates.'}];
    await page.route('**/api/v1/events', (route) => route.abort());
    await page.route('**/api/v1/status', async (route) => route.fulfill({json: {...await (await route.fetch()).json(), warnings}}));
    await page.goto(scanner.url);
    assert.match(await page.locator('#warnings li').innerText(), /^Uhr: 2026-11-25 06:22 UTC, nicht von einem Zeitserver\. Den Scanner mit/);
    await page.unrouteAll({behavior: 'ignoreErrors'});
    await page.context().close();
  });
  assert.equal((await ask(scanner, 'status')).scan, null);
});
