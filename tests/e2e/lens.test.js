// The lens calibration of a camera with lasers on the page: from a board waved in front of the simulated camera to a scan with
// the solved lens.

import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, scan, scanFolders, startScanner} from './scanner.js';

const rig = ['--simulate-laser', '--simulate-lens', '--simulate-speed', '4'];
const told = {fx: 682.4, fy: 682.4, cx: 409.5, cy: 307.5, width: 820, height: 616};
// The lens of --simulate-lens.
const truth = {fx: 1.012 * told.fx, fy: 1.010 * told.fy, cx: told.cx + 0.006 * told.width, cy: told.cy - 0.006 * told.height, k1: -0.06, k2: 0.02};
const draft = {snapshots: 4, leaf_size_mm: 4, calibrate: 'told'};

/** @param {Record<string, number>} lens */
function expectTruth(lens) {
  for (const [key, limit] of Object.entries({fx: 0.7, fy: 0.7, cx: 0.5, cy: 0.5, k1: 0.003, k2: 0.012})) {
    assert.ok(Math.abs(lens[key] - truth[key]) < limit, `${key}: ${lens[key]}, not ${truth[key]}`);
  }
}

async function lensOfNewestScan(scanner) {
  const folders = (await scanFolders(scanner)).sort();
  return JSON.parse(await readFile(`${folders.at(-1)}/scan.json`, 'utf8')).sensor;
}

test('the lens is found from a board, kept, used by a scan, and taken back', async (t) => {
  const scanner = await startScanner(t, {rig});
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, scanner.url);
  await goTo(page, 'Calibrate');
  await page.getByRole('heading', {name: 'The camera’s lens'}).waitFor();
  await page.getByText('As configured; not calibrated for this camera yet.').waitFor();
  await picture(page, 'lens-before');
  const board = await fetch(await page.getByRole('link', {name: 'A4'}).evaluate((link) => link.href));
  assert.equal(board.headers.get('content-type'), 'application/pdf');
  assert.match(await board.text(), /^%PDF-1\.4/);

  await page.getByRole('button', {name: 'Show the board'}).click();
  await page.getByText(/[3-9] of 12 pictures taken/).waitFor();
  await picture(page, 'lens-looking');
  assert.deepEqual(await complaints(page), []);
  await page.getByText('Lens calibrated').waitFor();
  await picture(page, 'lens-found');
  assert.deepEqual(await complaints(page), []);
  const {run} = await ask(scanner, 'calibration');
  expectTruth(run.report.lens);

  await page.getByRole('button', {name: 'Keep it'}).click();
  await page.getByText(/for camera simulated-laser; corners lie within 0\.\d\d pixels/).waitFor();
  const {lens} = await ask(scanner, 'calibration');
  expectTruth(lens.kept);
  await scan(scanner, draft);
  expectTruth(await lensOfNewestScan(scanner));

  await page.getByRole('button', {name: 'Back to the settings’ lens'}).click();
  await page.getByText('As configured; not calibrated for this camera yet.').waitFor();
  assert.deepEqual(faults, []);
});

test('a look at the board is cancelled, or solved too early and refused in words', async (t) => {
  const scanner = await startScanner(t, {rig});
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, `${scanner.url}#calibrate`, {screen: 'phone', colorScheme: 'dark'});
  await page.getByRole('button', {name: 'Show the board'}).click();
  await page.getByText(/[1-9] of 12 pictures taken/).waitFor();
  await page.locator('#lens-cancel').click();
  await page.locator('#lens-outcome').getByText('Cancelled').waitFor();
  assert.ok(await overflow(page) <= 0);

  // On a busy machine the click may come so late that the pictures suffice: then once more.
  const isRefused = async () => {
    await page.getByRole('button', {name: 'Show the board'}).click();
    await page.getByRole('button', {name: 'That is enough'}).click();
    const found = page.getByText('Lens calibrated');
    await page.getByText('The lens is not known').or(found).waitFor();
    const isFound = await found.isVisible();
    isFound && await page.getByRole('button', {name: 'Discard it'}).click();
    return !isFound;
  };
  for (let attempt = 1; !await isRefused(); ++attempt) {
    assert.ok(attempt < 10, 'five pictures suffice');
  }
  await page.getByText(/% of the picture only: a lens distorts most at the edges|only a tilted board shows the focal length/).waitFor();
  await picture(page, 'lens-refused');
  assert.ok(await overflow(page) <= 0);
  assert.deepEqual(await complaints(page), []);
  assert.equal((await ask(scanner, 'calibration')).lens.kept, null);
  assert.deepEqual(faults, []);
});

test('a board is shown to a Kinect\'s infrared camera, and views are counted', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '4']});
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, `${scanner.url}#calibrate`);
  await page.getByRole('heading', {name: 'The Kinect’s optics'}).waitFor();
  await page.getByText('Not done for this sensor.').waitFor();  // its walls are offered as well
  await page.getByText('Not measured with a board yet.').waitFor();
  assert.equal((await ask(scanner, 'calibration')).lens, null);
  const refused = await fetch(`${scanner.url}api/v1/calibration`, {method: 'PATCH', headers: {'Content-Type': 'application/json'}, body: '{"lens": "keep"}'});
  assert.equal(refused.status, 404);

  await page.getByRole('button', {name: 'Show the board'}).click();
  await page.getByText(/[1-9] of 24 pictures taken/).waitFor();
  await picture(page, 'lens-kinect');
  assert.deepEqual(await complaints(page), []);
  await page.locator('#lens-cancel').click();
  await page.getByText('Cancelled').first().waitFor();
  await page.getByText('Not measured with a board yet.').waitFor();
  assert.deepEqual(faults, []);
});
