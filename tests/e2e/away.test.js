import assert from 'node:assert/strict';
import {test} from 'node:test';

import {chooseQuickScan, goTo, openBrowser, openPage} from './browser.js';
import {startScanner} from './scanner.js';

test('the page says that the scanner is gone, finds it again, and lists the scan that died with it', async (t) => {
  const scanner = await startScanner(t);
  const {page} = await openPage(await openBrowser(t), scanner.url);
  await chooseQuickScan(page, 200);
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.waitForFunction(() => Number(document.getElementById('dial-done').textContent) >= 2);

  await scanner.end('SIGKILL');
  await page.getByRole('alert').filter({hasText: 'The scanner does not answer'}).waitFor();
  assert.equal(await page.title(), 'No answer · Octurn');
  assert.ok(await page.getByRole('button', {name: 'End scan'}).isDisabled());
  await page.getByRole('button', {name: 'Try now'}).click();
  assert.ok(await page.getByRole('button', {name: 'Try now'}).isVisible());

  await scanner.restart();
  await page.locator('#away').waitFor({state: 'hidden'});
  await page.getByText('Scan interrupted', {exact: true}).waitFor();
  await goTo(page, 'Library');
  await page.locator('#rows > li').filter({hasText: 'Interrupted'}).getByText(/^\d+ of 200 snapshots kept$/).waitFor();
});
