// Accessibility checks of a page: axe-core, contrast in both colour schemes and in forced colours, overflow.

import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {createRequire} from 'node:module';

import {openPage, picture} from './browser.js';

const axe = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/**
 * The violations that axe finds, one line each. Without preloading, which parses all styles again for a rule on sounds.
 * @param {Object} [options]  of axe, such as the rules to run
 */
export async function complaints(page, options = {}) {
  if (!await page.evaluate(() => 'axe' in globalThis)) {
    await page.evaluate(axe);
  }
  const {violations} = await page.evaluate((given) => globalThis.axe.run({resultTypes: ['violations'], preload: false, ...given}), options);
  return violations.map(({id, nodes}) => `${id}: ${nodes.map(({target}) => target).join(', ')}`);
}

/**
 * The texts with too little contrast in the other colour scheme, of which it stores a picture.
 * @param {string} name  of the picture @param {'light' | 'dark'} usual  the scheme to restore
 */
async function faintInOther(page, name, usual) {
  const other = usual === 'dark' ? 'light' : 'dark';
  await page.emulateMedia({colorScheme: other});
  const found = await complaints(page, {runOnly: ['color-contrast']});
  await picture(page, `${name}-${other}`);
  await page.emulateMedia({colorScheme: usual});
  return found;
}

/**
 * The texts with too little contrast in forced colours (Windows High Contrast). Axe would take the page's own colours: it
 * reads -webkit-text-fill-color, whose computed value is not the forced colour.
 */
const faintInForcedColours = (page) => page.evaluate(() => {
  const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
  const light = (colour) => numbers(colour).slice(0, 3).map((value) => value / 255)
      .map((value) => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4)
      .reduce((sum, value, channel) => sum + value * [0.2126, 0.7152, 0.0722][channel], 0);
  const alpha = (colour) => numbers(colour)[3] ?? 1;
  const behind = (element) => {
    const colour = getComputedStyle(element).backgroundColor;
    return alpha(colour) === 1 || !element.parentElement ? colour : behind(element.parentElement);
  };
  const contrast = (one, other) => (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05);
  const isText = (element) => [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim() !== '');
  return [...document.body.querySelectorAll('*:not(script, noscript, option)')]
      .filter((element) => isText(element) && element.checkVisibility({checkVisibilityCSS: true, checkOpacity: true}) &&
        !element.closest(':disabled, [aria-disabled=true], .unseen'))
      .map((element) => ({element, ink: getComputedStyle(element).color, paper: behind(element)}))
      .filter(({ink, paper}) => contrast(light(ink), light(paper)) < 4.5)
      .map(({element, ink, paper}) => `${element.id || element.className || element.dataset.text || element.tagName}: ${ink} on ${paper}`);
});

/** The violations of a page in another language. Contrast is left out, as the colours are the first language's. */
export const badWords = (page) => complaints(page, {rules: {'color-contrast': {enabled: false}}});

/** The visible texts in which the end of a line could part a number from its unit. */
export const parted = (page) => page.evaluate(() => {
  const found = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const texts = [];
  while (found.nextNode()) {
    const {parentElement, data} = found.currentNode;
    if (parentElement.checkVisibility() && !parentElement.closest('script, noscript, select')) {
      texts.push(data);
    }
  }
  return texts.filter((text) => /\d (?:mm|cm|cm³|m|ms|s|min|h|byte|kB|MB|GB|%|V)(?![\p{L}\p{N}])/u.test(text));
});

/**
 * By how much the page is wider than the screen, pixels. A phone zooms out of such a page, and innerWidth grows with it.
 */
export const overflow = (page) => page.locator('html').evaluate((root) => root.scrollWidth - root.clientWidth);

/** In forced colours every text can be read, and the chosen option can be told from the others. */
async function lookInForcedColours(page, name) {
  await page.emulateMedia({forcedColors: 'active'});
  assert.deepEqual(await faintInForcedColours(page), [], name);
  assert.doesNotMatch(await page.locator('#live').evaluate((live) => getComputedStyle(live).backgroundColor), /rgba/, 'the picture shines through');
  const outlineOf = (selector) => page.locator(selector).first().evaluate((element) => getComputedStyle(element).outlineStyle);
  assert.deepEqual(await Promise.all(['.choice:has(:checked)', '.choice:not(:has(:checked))', '.places [aria-current]'].map(outlineOf)),
      ['solid', 'none', 'solid']);
  await picture(page, `${name}-forced`);
  await page.emulateMedia({forcedColors: 'none'});
}

/** The screens on which the page is tested, each with its colour scheme. */
export const testedScreens = /** @type {const} */ ([['phone', 'dark'], ['desktop', 'light']]);

/**
 * Goes through states of the page on one screen and checks the accessibility of each in both colour schemes.
 *
 * @param {import('playwright-core').Browser} browser
 * @param {string} url
 * @param {Record<string, (page: import('playwright-core').Page) => unknown>} states  functions that bring the page into them
 * @param {'phone' | 'desktop'} screen
 * @param {'light' | 'dark'} colorScheme
 */
export async function walk(browser, url, states, screen, colorScheme) {
  const {page} = await openPage(browser, url, {screen, colorScheme});
  for (const [name, reach] of Object.entries(states)) {
    await reach(page);
    assert.deepEqual(await complaints(page), [], name);
    assert.deepEqual(await faintInOther(page, `${name}-${screen}`, colorScheme), [], `${name}, not ${colorScheme}`);
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    assert.deepEqual(await parted(page), [], name);
    await picture(page, `${name}-${screen}-${colorScheme}`);
    await lookInForcedColours(page, `${name}-${screen}`);
  }
  await page.context().close();
}
