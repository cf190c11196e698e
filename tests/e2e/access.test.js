// The accessibility of the page: on a phone, by keyboard, with a screen reader, in both colour schemes.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {testedScreens, walk} from './access.js';
import {goTo, openBrowser, openPage} from './browser.js';
import {ask, scan, startScanner} from './scanner.js';

const draft = {snapshots: 3, leaf_size_mm: 8, filter: 'basic'};

/** The states of a page without faults, as functions that bring the page into them. @param {any} finished  a finished scan */
const statesOf = (scanner, finished) => ({
  form: (page) => page.getByText('All settings').click(),
  library: async (page) => {
    await goTo(page, 'Library');
    await page.locator('#rows > li').first().waitFor();
  },
  calibrate: async (page) => {
    await goTo(page, 'Calibrate');
    await page.locator('#pose-no-picture').waitFor({state: 'hidden'});
  },
  settings: async (page) => {
    await goTo(page, 'Settings');
    await page.locator('#cards').waitFor();
    await page.locator('#cards').evaluate((cards) => cards.querySelectorAll('details').forEach((details) => { details.open = true; }));
  },
  checked: async (page) => {
    await goTo(page, 'Scanner');
    await page.getByRole('button', {name: 'Check now'}).click();
    await page.locator('.finding').first().waitFor();
  },
  finished: async (page) => {
    await page.goto(`${new URL('/', page.url())}#${finished.id}`);
    await page.locator('#tools').waitFor();
    assert.equal(await page.locator('#view').evaluate((view) => getComputedStyle(view).touchAction), 'pan-y', 'a finger on it can scroll');
    // The Scanner's styles have come, too.
    const wide = (id) => page.locator(id).evaluate((element) => element.getBoundingClientRect().width);
    assert.ok(await wide('#reasons') > 0.9 * await wide('#verdict'), 'reasons take the width of the panel');
  },
  renaming: (page) => page.getByRole('button', {name: 'Rename this scan'}).click(),
  scanning: async (page) => {
    await page.keyboard.press('Escape');
    await ask(scanner, 'scans', 'POST', {...draft, snapshots: 400});
    await page.getByRole('link', {name: 'Show its progress'}).click();
    await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  },
  ended: async (page) => {
    await ask(scanner, `scans/${(await ask(scanner, 'status')).scan.id}/cancel`, 'POST');
    await page.getByText('Scan ended', {exact: true}).waitFor();
  },
});

/** Starts a scan by keyboard alone. */
async function startByKeyboard(scanner, browser) {
  const {page} = await openPage(browser, 'about:blank');
  await page.addInitScript(() => localStorage.setItem('octurn-scan', '{"filter": "basic"}'));  // one picture a stop
  await page.goto(scanner.url);
  await page.locator('[data-panel=form]').waitFor();
  await page.locator('#all-settings > summary').focus();
  await page.keyboard.press('Enter');
  const snapshots = page.getByLabel('Snapshots per turn', {exact: true});
  await snapshots.focus();
  await page.keyboard.press('ControlOrMeta+a');
  await page.keyboard.type('4');
  await page.keyboard.press('Tab');  // to the method
  await page.keyboard.press('Tab');  // to the leaf size
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowLeft');
  assert.ok(await page.getByLabel('Draft').isChecked());
  while (!await page.getByRole('button', {name: 'Start scan'}).evaluate((button) => button === document.activeElement)) {
    await page.keyboard.press('Tab');
  }
  await page.keyboard.press('Enter');
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement?.textContent), 'Scanning');
  await page.getByRole('status').filter({hasText: /^The model of .* is ready\./}).waitFor();
  await page.context().close();
}

/** Opens a scan on a phone as if its file had `bytes`. */
async function lookAtLarge(scanner, browser, finished, bytes) {
  const {page} = await openPage(browser, 'about:blank', {screen: 'phone'});
  await page.route('**/api/v1/scans', async (route) => {
    const body = await (await route.fetch()).json();
    body.scans.find(({id}) => id === finished.id).model.bytes = bytes;
    await route.fulfill({json: body});
  });
  await page.route(`**/api/v1/scans/${finished.id}/builds`, async (route) => {
    const body = await (await route.fetch()).json();
    body.builds[0].model.bytes = bytes;
    await route.fulfill({json: body});
  });
  await page.goto(`${scanner.url}#${finished.id}`);
  await page.getByRole('button', {name: 'Show it (21 MB)'}).click();
  await page.locator('#tools').waitFor();
  await page.unrouteAll({behavior: 'ignoreErrors'});  // a request may be pending
  await page.context().close();
}

test('the page is for everyone', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  const finished = await scan(scanner, draft);
  for (const [screen, colorScheme] of testedScreens) {
    await t.test(`no state of it overflows a ${screen} or shuts anyone out, ${colorScheme}`,
        () => walk(browser, scanner.url, statesOf(scanner, finished), screen, colorScheme));
  }
  await t.test('the keyboard alone starts a scan, and the end of it is announced', () => startByKeyboard(scanner, browser));
  await t.test('a phone is asked before a large model is loaded', () => lookAtLarge(scanner, browser, finished, 21e6));
});
