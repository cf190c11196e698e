import assert from 'node:assert/strict';
import {test} from 'node:test';

import {emptyPage, openBrowser} from './browser.js';
import {configWith} from './password.js';
import {startScanner} from './scanner.js';

/** Opens the page in a browser with this password. */
async function visit(browser, url, password) {
  const page = await emptyPage(browser, {password});
  const response = await page.goto(url);
  return {page, status: response?.status()};
}

test('the page opens with its password alone', async (t) => {
  const password = 'open sesame: ä "quoted"';
  const config = await configWith(t, password);
  const scanner = await startScanner(t, {rig: ['--simulate', '--config', config]});
  const browser = await openBrowser(t);

  assert.equal((await fetch(scanner.url)).status, 401);
  const refused = await visit(browser, scanner.url, 'open');
  assert.equal(refused.status, 401);
  assert.ok(await refused.page.getByRole('button', {name: 'Start scan'}).isHidden());

  const {page} = await visit(browser, scanner.url, password);
  await page.getByRole('button', {name: 'Start scan'}).waitFor();
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'}); // the page's own requests are accepted, too
});
