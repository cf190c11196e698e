import assert from 'node:assert/strict';
import {basename} from 'node:path';
import {test} from 'node:test';

import {emptyPage, goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, quick, scan, scanFolders, startScanner} from './scanner.js';

const draft = {snapshots: 3, leaf_size_mm: 8, filter: 'basic'};

test('earlier scans are listed, looked at, renamed and deleted', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, scanner.url);
  await goTo(page, 'Library');
  await page.getByText('No scans yet').waitFor();

  const first = await scan(scanner, draft);
  const rows = page.locator('#rows > li');
  await rows.first().locator('.scan-name').click(); // the page may not have seen it run
  await page.locator(`#download[href="${first.model.url.slice(1)}"]`).waitFor(); // from here on nothing requests its preview
  const second = await scan(scanner, draft);
  await goTo(page, 'Library');
  await rows.nth(1).waitFor();
  assert.ok(await page.getByText('No scans yet').isHidden());

  await rows.nth(1).locator('.scan-name').click();
  await page.locator(`#download[href="${first.model.url.slice(1)}"]`).waitFor();
  assert.equal(new URL(page.url()).hash, `#${first.id}`);

  await page.getByRole('button', {name: 'Rename this scan'}).click();
  await page.getByLabel('Name', {exact: true}).fill('Möwe <b>1</b>');
  await page.keyboard.press('Enter');
  await page.getByRole('heading', {name: 'Möwe <b>1</b>'}).waitFor();
  assert.equal((await ask(scanner, `scans/${first.id}`)).name, 'Möwe <b>1</b>');

  await page.getByLabel('Notes', {exact: true}).fill('Plaster, 1920.\nThe left wing is <i>glued</i>.');
  await page.keyboard.press('Tab');
  await page.getByText('Saved.', {exact: true}).waitFor();
  assert.equal((await ask(scanner, `scans/${first.id}`)).notes, 'Plaster, 1920.\nThe left wing is <i>glued</i>.');
  await picture(page, 'notes');

  await page.reload();  // the address identifies the scan
  await page.getByRole('heading', {name: 'Möwe <b>1</b>'}).waitFor();
  await page.waitForFunction(() => document.getElementById('notes')?.value.endsWith('<i>glued</i>.'));
  await goTo(page, 'Library');
  await rows.nth(1).getByRole('button', {name: /^Delete/}).click();
  await page.waitForFunction(() => document.querySelectorAll('#rows > li').length === 1);
  const [box, words] = await Promise.all(['#deleted', '#deleted-text'].map((part) => page.locator(part).boundingBox()));
  const off = words.y + words.height / 2 - box.y - box.height / 2;
  assert.ok(Math.abs(off) <= 1, `the message is in the middle of its box, not ${off} pixels below it`);
  await page.getByRole('status').getByRole('button', {name: 'Undo'}).click();
  await rows.nth(1).getByText('Möwe <b>1</b>').waitFor();
  await rows.nth(1).locator('.scan-name').click();
  await page.locator(`#download[href="${first.model.url.slice(1)}"]`).waitFor();
  await page.goBack();
  await rows.nth(1).waitFor();

  await rows.nth(1).getByRole('button', {name: /^Delete/}).click();
  await page.waitForFunction(() => document.querySelectorAll('#rows > li').length === 1);
  assert.deepEqual((await scanFolders(scanner)).map((path) => basename(path)), [second.id]);

  await page.getByText('Bin (1)').click();
  await picture(page, 'bin');
  await page.getByRole('button', {name: 'Empty the bin'}).click();
  await page.getByRole('button', {name: 'Keep them'}).click();
  await page.getByRole('button', {name: 'Restore: Möwe <b>1</b>'}).click();
  await rows.nth(1).waitFor();
  await page.locator('#bin').waitFor({state: 'hidden'});
  assert.equal((await scanFolders(scanner)).length, 2);
  assert.deepEqual(faults, []);
});

test('what somebody else does to the scans is seen without a reload, and a refusal wherever the page is scrolled to', async (t) => {
  const scanner = await startScanner(t);
  const first = await scan(scanner, draft);
  const second = await scan(scanner, draft);
  const {page} = await openPage(await openBrowser(t), scanner.url, {screen: 'phone'});
  await goTo(page, 'Library');
  const rows = page.locator('#rows > li');
  await rows.nth(1).waitFor();
  const longest = 'ü'.repeat(100);
  await rows.nth(1).getByRole('button', {name: /^Rename/}).click();
  await page.getByLabel('Name', {exact: true}).fill(longest);
  await page.keyboard.press('Enter');
  await rows.nth(1).getByText(longest).waitFor();

  await assert.rejects(ask(scanner, `scans/${first.id}`, 'PATCH', {}), /none of .*name.*, .*notes/);
  await ask(scanner, `scans/${first.id}`, 'PATCH', {name: 'Elsewhere'});
  await rows.nth(1).getByText('Elsewhere').waitFor();
  await page.route('**/api/v1/scans', (route) => route.abort());  // as if the list came too late
  await ask(scanner, `scans/${first.id}`, 'DELETE');
  await page.getByRole('button', {name: 'Delete: Elsewhere'}).scrollIntoViewIfNeeded();
  await page.getByRole('button', {name: 'Delete: Elsewhere'}).click();
  const alert = page.getByRole('alert').filter({hasText: 'The scan was not deleted'});
  await alert.waitFor();
  const {y, height} = await alert.boundingBox();
  assert.ok(y >= 0 && y + height <= page.viewportSize().height, `seen where one looks, not at ${y}`);
  await page.unroute('**/api/v1/scans');
  await page.waitForFunction(() => document.querySelectorAll('#rows > li').length === 1);
  assert.equal(await rows.first().getAttribute('data-key'), second.id);
});

test('a scan that somebody else starts is followed, and can be looked away from', async (t) => {
  const scanner = await startScanner(t);
  const earlier = await scan(scanner, draft);
  const {page} = await openPage(await openBrowser(t), scanner.url);
  await goTo(page, 'Library');
  await page.locator(`#rows [data-key="${earlier.id}"]`).waitFor();
  await goTo(page, 'Scan');
  const {id} = await ask(scanner, 'scans', 'POST', {...draft, snapshots: 200});
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  const {page: byAddress} = await openPage(await openBrowser(t), `${scanner.url}#${id}`);
  await byAddress.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await page.goto(`${scanner.url}#${earlier.id}`);
  await page.getByText('A scan is running.', {exact: true}).waitFor();
  await page.getByRole('link', {name: 'Show its progress'}).click();
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await ask(scanner, `scans/${id}/cancel`, 'POST');
  await page.getByText('Scan ended', {exact: true}).waitFor();
});

test('where the browser has no WebGL, the page says so and the model can still be downloaded', async (t) => {
  const scanner = await startScanner(t);
  const {id} = await scan(scanner, draft);
  const {page} = await openPage(await openBrowser(t, {hasWebGl: false}), `${scanner.url}#${id}`);
  await page.getByText('This browser cannot draw in 3D').waitFor();
  const download = page.getByRole('link', {name: 'Download STL'}).first();
  const [arrived] = await Promise.all([page.waitForEvent('download'), download.click()]);
  assert.equal(arrived.suggestedFilename(), 'Scan.stl');
});

test('quick clicks all count, and a page whose storage is blocked works', async (t) => {
  const scanner = await startScanner(t);
  await scan(scanner, draft);
  await scan(scanner, draft);
  const page = await emptyPage(await openBrowser(t));
  await page.addInitScript(() => {
    for (const kind of ['localStorage', 'sessionStorage']) {
      Object.defineProperty(globalThis, kind, {get: () => {
        throw new DOMException('denied', 'SecurityError');
      }});
    }
  });
  await page.goto(scanner.url);
  await page.getByRole('button', {name: 'Start scan'}).waitFor();
  await goTo(page, 'Library');
  const rows = page.locator('#rows > li');
  await rows.nth(1).waitFor();
  let answer = () => {};
  const asked = new Promise((resolve) => {
    answer = resolve;
  });
  await page.route('**/api/v1/scans/*', async (route) => {
    await asked;  // as on a slow network: the first answer comes after the second click
    await route.continue();
  });
  await rows.nth(0).getByRole('button', {name: /^Delete/}).click();
  await rows.nth(1).getByRole('button', {name: /^Delete/}).click();
  answer();
  await page.getByText('No scans yet').waitFor();
});

/** Waits until something on the page is so. */
const becomes = (page, condition, argument = undefined) => page.waitForFunction(condition, argument, {polling: 100});
const keysIn = (page) => page.locator('#rows > li').evaluateAll((cards) => cards.map((card) => card.dataset.key));
const remove = (page, index) => page.locator('#rows > li').nth(index).getByRole('button', {name: /^Delete/}).click();

/** Cards of scans without a name, in two columns on a phone, can be told apart. One whose picture does not come has none. */
async function compareCards(browser, url) {
  const {page} = await openPage(browser, 'about:blank', {screen: 'phone'});
  await page.setViewportSize({width: 360, height: 640});
  await page.route('**/thumbnail.png*', (route) => route.fulfill({status: 500}));
  await page.goto(`${url}#library`);
  await page.locator('#rows > li').nth(3).waitFor();
  await becomes(page, () => [...document.querySelectorAll('#rows img')].slice(0, 2).every((image) => image.hidden));
  assert.ok(await page.locator('#rows .scan-picture svg').first().isVisible());
  const cards = await page.locator('#rows > li').evaluateAll((all) => all.map((card) => {
    const name = card.querySelector('.scan-name');
    return {left: card.getBoundingClientRect().left, top: card.getBoundingClientRect().top, name: name.textContent,
      cut: Math.max(name.scrollHeight - name.clientHeight, name.scrollWidth - name.clientWidth)};
  }));
  assert.equal(new Set(cards.map(({left}) => left)).size, 2, 'two columns');
  assert.equal(cards[0].top, cards[1].top);
  assert.ok(cards.every(({cut, name}) => cut <= 0 && /\d:\d\d/.test(name)), JSON.stringify(cards));
  await picture(page, 'library-unnamed-phone');
  await page.context().close();
}

/** Back from a scan the library is where it was left, and a search lasts through a reload. */
async function keepPlace(page) {
  await page.setViewportSize({width: 390, height: 500});
  await page.evaluate(() => scrollTo(0, 300));
  await page.locator('#rows > li').nth(2).locator('.scan-name').evaluate((link) => link.click());
  await page.locator('#details-name').waitFor();
  await page.goBack();
  await becomes(page, () => scrollY === 300);
  await page.setViewportSize({width: 1280, height: 860});
  await page.getByLabel('Search the scans').fill('found by nobody');
  await page.getByText('No scan has that in its name, date, number or tags.').waitFor();
  await page.reload();
  await page.getByText('No scan has that in its name, date, number or tags.').waitFor();
  assert.equal(await page.getByLabel('Search the scans').inputValue(), 'found by nobody');
  await page.getByLabel('Search the scans').fill('');
}

/** The focus goes on to the next card, and Undo counts while another delete waits for its answer. */
async function removeAndUndo(page) {
  const [first, second, ...others] = await keysIn(page);
  await remove(page, 0);
  await becomes(page, (key) => document.activeElement?.closest('li')?.dataset.key === key, second);
  let answer = () => {};
  const held = new Promise((resolve) => {
    answer = () => resolve(null);
  });
  await page.route('**/api/v1/scans/*', async (route) => {
    await held;
    await route.continue();
  });
  await remove(page, 0);
  await page.getByRole('status').getByRole('button', {name: 'Undo'}).click();
  answer();
  const hasKeys = (keys) => [...document.querySelectorAll('#rows > li')].map(({dataset}) => dataset.key).join() === keys;
  await becomes(page, hasKeys, [first, ...others].join());
  await page.unroute('**/api/v1/scans/*');
  await page.locator('#bin').locator('summary').click();
  await page.getByRole('button', {name: /^Restore/}).click();
  await page.locator('#rows > li').nth(others.length + 1).waitFor();
}

/** Of several chosen scans those before a refusal are gone, and Undo brings them back. */
async function removeChosen(page) {
  const keys = await keysIn(page);
  await page.getByRole('button', {name: 'Select', exact: true}).click();
  for (const index of [0, 1, 2]) {
    await page.locator('#rows > li').nth(index).getByRole('checkbox').check();
  }
  await page.route(`**/api/v1/scans/${keys[1]}`, (route) => route.fulfill({
    status: 409, contentType: 'application/problem+json',
    json: {code: 'busy', title: 'Busy', detail: 'it is read', parameters: {}, hint: ''},
  }));
  await page.getByRole('button', {name: 'Delete 3'}).click();
  await page.getByRole('alert').filter({hasText: 'Not all scans were deleted'}).waitFor();
  await becomes(page, (count) => document.querySelectorAll('#rows > li').length === count, keys.length - 1);
  assert.deepEqual(await keysIn(page), keys.slice(1));
  await page.getByRole('button', {name: 'Dismiss'}).click();
  await page.getByRole('status').getByRole('button', {name: 'Undo'}).click();
  await becomes(page, (count) => document.querySelectorAll('#rows > li').length === count, keys.length);
}

/** The address of no scan shows the form, and asks for nothing. */
async function openNoScan(page) {
  const missing = [];
  page.on('response', (response) => response.status() === 404 && missing.push(response.url()));
  await page.evaluate(() => {
    location.hash = 'nonsense';
  });
  await page.getByRole('button', {name: 'Start scan'}).waitFor();
  assert.equal(await page.evaluate(() => location.hash), '');
  const tab = page.getByRole('navigation').getByRole('link', {name: 'Scan', exact: true});
  assert.equal(await tab.getAttribute('aria-current'), 'page');
  await page.waitForTimeout(2500);  // two polls
  assert.deepEqual(missing, []);
}

test('the library loses neither its place nor what was asked of it', async (t) => {
  const scanner = await startScanner(t, quick);
  for (let count = 0; count < 4; ++count) {
    await scan(scanner, draft);
  }
  const browser = await openBrowser(t);
  await t.test('cards without names', () => compareCards(browser, scanner.url));
  const {page} = await openPage(browser, `${scanner.url}#library`);
  await page.locator('#rows > li').nth(3).waitFor();
  await t.test('back from a scan, and after a reload', () => keepPlace(page));
  await page.locator('#rows > li').nth(3).waitFor();
  await t.test('by a delete and its undoing', () => removeAndUndo(page));
  await t.test('by the delete of several that is refused', () => removeChosen(page));
  await t.test('an address of no scan', () => openNoScan(page));
});
