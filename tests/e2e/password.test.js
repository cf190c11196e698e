import assert from 'node:assert/strict';
import {test} from 'node:test';

import {emptyPage, goTo, openBrowser, openPage} from './browser.js';
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

test('a password that is set on the page opens it, and is not sent itself', async (t) => {
  const password = 'open sesame: ä';
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  const {page} = await openPage(browser, scanner.url, {password});
  const sent = [];
  page.on('request', (request) => sent.push(request.postData() ?? ''));
  await goTo(page, 'Settings');
  await page.getByLabel('New password').fill('sevenxx');
  await page.getByRole('button', {name: 'Set password'}).click();
  await page.getByText('Use 8 to 100 letters, digits and signs.').waitFor();
  await page.getByLabel('New password').fill(password);
  await page.getByRole('button', {name: 'Set password'}).click();
  await page.getByText('The page asks for a password.').waitFor();
  assert.equal(sent.filter((body) => /^\{"hash":"[0-9a-f]{32}"\}$/.test(body)).length, 1);
  assert.ok(!sent.some((body) => body.includes('sesame')));
  assert.equal((await fetch(scanner.url)).status, 401);
  assert.equal((await visit(browser, scanner.url, password)).status, 200);
});
