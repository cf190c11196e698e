import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {chooseQuickScan, openBrowser, openPage, picture} from './browser.js';
import {measure} from '../web/mesh_file.js';
import {ask, startScanner} from './scanner.js';

test('an object is scanned, turned over, scanned again, and downloaded as one model; the other side is taken back', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '20']});
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await chooseQuickScan(page, 8);
  await page.getByRole('button', {name: 'Start scan'}).click();
  const add = page.getByRole('button', {name: 'Turn it over and scan the underside'});
  await add.waitFor();
  await add.click();
  await page.getByText('Side 2 is in the model').waitFor();
  assert.match(await page.locator('#side-rows').innerText(), /shares \d+ % of its surface[^]*fits to \d\.\d\d mm/);

  const {scans: [pose, first]} = await ask(scanner, 'scans');
  assert.deepEqual([pose.pose_of.scan, first.poses.length, first.build], [first.id, 1, 1]);
  assert.equal(await page.locator('#rows > li').count(), 1, 'both are one entry of the list');
  const download = page.getByRole('link', {name: 'Download STL'}).first();
  const [arrived] = await Promise.all([page.waitForEvent('download'), download.click()]);
  const mesh = measure(await readFile(await arrived.path()));
  assert.equal(mesh.openEdges, 0);
  assert.equal(mesh.triangles, first.model.triangles);
  await page.locator('#tools').waitFor();
  await picture(page, 'both-sides');
  assert.deepEqual(await complaints(page), []);
  assert.ok(await overflow(page) <= 0, `${await overflow(page)} pixels too wide`);

  await page.getByRole('button', {name: 'Take back: side 2'}).click();
  await add.waitFor();
  const {scans} = await ask(scanner, 'scans');
  assert.deepEqual([scans.length, scans[0].build, scans[0].poses], [1, 0, []]);
  assert.deepEqual(faults, []);
});
