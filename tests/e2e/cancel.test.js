import assert from 'node:assert/strict';
import {readFile, readdir} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';

import {chooseQuickScan, goTo, openBrowser, openPage} from './browser.js';
import {measure} from '../web/mesh_file.js';
import {ask, scanFolders, startScanner} from './scanner.js';

test('a scan cancelled half way ends at once, and keeps its snapshots', async (t) => {
  const scanner = await startScanner(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  const snapshots = 200;
  await chooseQuickScan(page, snapshots);
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.waitForFunction(() => Number(document.getElementById('dial-done').textContent) >= 5);
  await page.getByRole('button', {name: 'End scan'}).click();

  await page.getByText('Scan ended', {exact: true}).waitFor();
  await goTo(page, 'Library');
  const row = page.getByRole('listitem').filter({hasText: 'Ended'});
  const kept = Number(/(\d+) of 200 snapshots kept/.exec(await row.getByText('snapshots kept').textContent())?.[1]);
  assert.ok(kept >= 5 && kept < snapshots, `${kept} kept`);
  await page.goBack();
  const [folder] = await scanFolders(scanner);
  assert.equal((await readdir(join(folder, 'snapshots'))).length, kept);
  assert.equal((await ask(scanner, 'status')).scan, null);
  await page.getByRole('button', {name: `Build the model of ${kept} snapshots`}).click();
  const download = page.locator('#download');
  await download.waitFor();
  const [arrived] = await Promise.all([page.waitForEvent('download'), download.click()]);
  assert.ok(measure(await readFile(await arrived.path())).triangles > 1000);

  await page.getByRole('link', {name: 'New scan'}).click();
  assert.ok(await page.getByRole('button', {name: 'Start scan'}).isEnabled());
  assert.deepEqual(faults, []);
});
