import assert from 'node:assert/strict';
import {basename} from 'node:path';
import {test} from 'node:test';

import {emptyPage, goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, scan, scanFolders, startScanner} from './scanner.js';

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

  await assert.rejects(ask(scanner, `scans/${first.id}`, 'PATCH', {}), /neither .*name.* nor .*notes/);
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
