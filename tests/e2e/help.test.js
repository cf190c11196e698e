// The scanner's own help pages, for somebody with a phone and no internet.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {startScanner} from './scanner.js';

for (const [screen, colorScheme] of [['phone', 'light'], ['desktop', 'dark']]) {
  test(`the help is read on a ${screen}, from the page and back`, async (t) => {
    const scanner = await startScanner(t);
    const {page, faults} = await openPage(await openBrowser(t), scanner.url, {screen, colorScheme});
    await page.getByRole('link', {name: 'Help'}).click();
    await page.getByRole('heading', {name: 'From a card to a model'}).waitFor();
    for (const title of await page.locator('nav li a').allInnerTexts()) {
      await page.locator('nav li a', {hasText: title}).click();
      await page.locator('[aria-current=page]', {hasText: title}).waitFor();
      if (screen === 'phone') {
        assert.deepEqual(await complaints(page), [], title);
      }
      assert.ok(await overflow(page) <= 0, `${title} is ${await overflow(page)} pixels too wide`);
      assert.ok(await page.evaluate(() => [...document.querySelectorAll('main ol')]
          .every((list) => getComputedStyle(list).listStyleType === 'decimal')), `steps of ${title} have numbers`);
      await page.waitForFunction(() => [...document.images].every((image) => image.complete));
      assert.ok(await page.evaluate(() => [...document.images].every((image) => image.naturalWidth > 0)), title);
    }
    await page.goto(new URL('help/wiring.html', scanner.url).href);
    await picture(page, `help-wiring-${screen}`);
    await page.getByRole('link', {name: 'Back to the scanner'}).click();
    await page.getByRole('button', {name: 'Start scan'}).waitFor();
    assert.deepEqual(faults, []);
  });
}

for (const [locale, link, title] of [
  ['de-DE', 'Hilfe', 'Von der Karte zum Modell'],
  ['es-ES', 'Ayuda', 'De la tarjeta al modelo'],
  ['fr-FR', 'Aide', 'De la carte au modèle'],
]) {
  test(`the page leads to the guide in its language, ${locale}`, async (t) => {
    const scanner = await startScanner(t);
    const {page, faults} = await openPage(await openBrowser(t), scanner.url, {screen: 'phone', locale});
    await page.getByRole('link', {name: link, exact: true}).click({timeout: 20000});
    await page.getByRole('heading', {name: title}).waitFor({timeout: 20000});
    assert.match(page.url(), /#5-scan$/);
    assert.deepEqual(await complaints(page), []);
    assert.ok(await overflow(page) <= 0, `${await overflow(page)} pixels too wide`);
    await picture(page, `help-guide-${locale}`, {fullPage: false});
    await page.getByRole('link', {name: 'English'}).click({timeout: 20000});
    await page.getByRole('heading', {name: 'From a card to a model'}).waitFor({timeout: 20000});
    assert.deepEqual(faults, []);
  });
}
