// Sizes that calipers confirm: a first-time user with a Kinect whose optics are not the data sheet's calibrates it on
// the page, by a printed board or by a known length. A block of 123 mm comes out 123 mm long, and the page says how exact
// its sides are.

import assert from 'node:assert/strict';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';

import {complaints} from './access.js';
import {goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, startScanner} from './scanner.js';

// Millimetres, longer side first. It stands on its end: nothing shows how the model is turned about the platform's axis.
const block = [60, 45, 123];
const most = 0.3;  // mm, of the height
const mostOfSides = 0.35;  // mm: their faces are seen at an angle

/** An STL of a block on the platform. */
function blockStl([width, depth, height]) {
  const corner = (/** @type {number} */ bits) =>
    [(bits & 1 ? 0.5 : -0.5) * width, (bits & 2 ? 0.5 : -0.5) * depth, bits & 4 ? height : 0];
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const triangles = sides.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);
  const stl = Buffer.alloc(84 + 50 * triangles.length);
  stl.writeUInt32LE(triangles.length, 80);
  triangles.forEach((corners, index) => corners.flatMap(corner).forEach((value, number) =>
    stl.writeFloatLE(value, 84 + 50 * index + 12 + 4 * number)));
  return stl;
}

/** A scanner with another Kinect than the data sheet's, and the block on its platform. */
async function startWithBlock(t) {
  const folder = await mkdtemp(join(tmpdir(), 'octurn-block-'));
  t.after(() => rm(folder, {recursive: true, force: true}));
  const file = join(folder, 'block.stl');
  await writeFile(file, blockStl(block));
  return startScanner(t, {rig: [`--simulate=${file}`, '--simulate-unit', '1', '--simulate-speed', '8']});
}

/** Scans as the page offers it. @returns {Promise<number[]>} the sizes that the page shows, mm */
async function scannedSizes(page) {
  await goTo(page, 'Scan');
  const start = page.getByRole('button', {name: 'Start scan'});
  const again = page.getByRole('link', {name: 'New scan'});
  await start.or(again).first().waitFor();
  await again.isVisible() && await again.click();
  await start.click();
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await page.getByRole('link', {name: 'Download STL'}).first().waitFor();
  return (await page.locator('#size').innerText()).match(/[\d.]+/g).map(Number);
}

/** Has the page measure the newest model beside the block's own sizes. @returns {Promise<number[]>} its errors, mm */
async function gaugeErrors(page) {
  await goTo(page, 'Calibrate');
  await page.getByRole('button', {name: 'Measure the newest model'}).click();
  await page.getByText('The newest model is a block').waitFor();
  for (const [index, size] of block.entries()) {
    await page.getByLabel('Length by calipers, mm').nth(index).fill(String(size));
  }
  await page.getByText(/^The model is off by .* on average/).waitFor();
  const errors = await page.locator('#lengths output').allInnerTexts();
  return errors.map((error) => Number.parseFloat(error.replace('−', '-')));
}

/** @param {number[]} errors */
function assertExact(errors) {
  assert.equal(errors.length, block.length);
  errors.forEach((error, index) => assert.ok(Math.abs(error) <= (index < 2 ? mostOfSides : most), `${errors}`));
}

/** Has the page look at a wall from two distances. */
async function flatten(scanner, page) {
  for (let walls = 1; walls <= 2; ++walls) {
    for (const box of await page.locator('#wall-ready').getByRole('checkbox').all()) {
      await box.check();
    }
    await page.getByRole('button', {name: 'Look at the wall'}).click();
    await page.getByText('The sensor’s unevenness is corrected').waitFor();
    for (let run = null; run?.report?.walls?.length !== walls; {run} = await ask(scanner, 'calibration')) {
      assert.ok(!['failed', 'refused', 'cancelled'].includes(run?.state), run?.error?.detail ?? run?.state);
      await page.waitForTimeout(100);
    }
  }
}

test('with a board of measured squares a block is as long as by calipers', async (t) => {
  const scanner = await startWithBlock(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await goTo(page, 'Calibrate');
  await page.getByText('Not measured with a board yet.').waitFor();
  await page.getByLabel('Side of a square, mm').fill('15');
  await page.getByRole('button', {name: 'Show the board'}).click();
  await page.getByText('The Kinect’s optics are measured').waitFor();
  await picture(page, 'kinect-board');
  assert.deepEqual(await complaints(page), []);
  await page.getByRole('button', {name: 'Keep it'}).click();
  await page.getByText(/Measured with a board on/).waitFor();
  await flatten(scanner, page);
  const sizes = await scannedSizes(page);
  await picture(page, 'block-by-board');
  assert.ok(Math.abs(sizes[2] - block[2]) <= most, `${sizes} mm`);
  const errors = await gaugeErrors(page);
  t.diagnostic(`by the board: ${errors} mm off`);
  await picture(page, 'gauge');
  assert.deepEqual(await complaints(page), []);
  assertExact(errors);
  await page.evaluate(() => { window.print = () => {}; });
  await page.getByRole('button', {name: 'Print', exact: true}).click();
  await page.emulateMedia({media: 'print'});
  await picture(page, 'gauge-report');
  assert.ok(await page.locator('#gauge-when').isVisible());
  assert.ok(!await page.getByRole('button', {name: 'Measure the newest model'}).isVisible());
  assert.ok(!await page.locator('header, footer, nav').first().isVisible());
  assert.deepEqual(faults, []);
});

test('with a length by calipers the next scan of a block is as long', async (t) => {
  const scanner = await startWithBlock(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await goTo(page, 'Calibrate');
  await flatten(scanner, page);
  const [, , before] = await scannedSizes(page);
  await goTo(page, 'Calibrate');
  await page.getByLabel('Length on the model, mm').fill(String(before));
  await page.getByLabel('Length by calipers, mm').fill(String(block[2]));
  await page.getByRole('button', {name: 'Set the scale'}).click();
  await page.getByText(/Models are made \d\.\d+% (smaller|larger) than the sensor tells/).waitFor();
  const {scale} = await ask(scanner, 'calibration');
  assert.equal(scale, Number((block[2] / before).toFixed(5)));
  const sizes = await scannedSizes(page);
  await picture(page, 'block-by-length');
  assert.ok(Math.abs(sizes[2] - block[2]) <= most, `${before} mm before, then ${sizes}`);
  const errors = await gaugeErrors(page);
  t.diagnostic(`by a length: ${errors} mm off`);
  assertExact(errors);
  assert.deepEqual(faults, []);
});
