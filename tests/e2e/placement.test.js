// Pose, scanned space and scale, set by hand on the page Calibrate.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {openBrowser, openPage} from './browser.js';
import {ask, startScanner} from './scanner.js';
import {fromSide, planOf} from '../../web/sensor/plans.js';

const axisLine = (page) => page.locator('#overlay [data-line=axis]').getAttribute('d');

/** Holds questions about the calibration after the next change of it. @returns {Promise<{asked: Promise<void>, answer: () => void}>} */
async function holdCalibration(page) {
  let [tellAsked, answer] = [() => {}, () => {}];
  const asked = new Promise((done) => { tellAsked = done; });
  const answered = new Promise((done) => { answer = done; });
  let isChanged = false;
  await page.route('**/api/v1/calibration', async (route) => {
    if (route.request().method() === 'PATCH') {
      const response = await route.fetch();
      isChanged = true;
      return route.fulfill({response});
    }
    if (isChanged) {
      tellAsked();
      await answered;
    }
    return route.continue();
  });
  return {asked, answer};
}

const nextPicture = (page) => page.evaluate(() => new Promise((done) => {
  requestAnimationFrame(() => requestAnimationFrame(() => done(null)));
}));

/** Moves the sensor by a step, saves the pose, and undoes it. */
async function setByHand(scanner, browser) {
  const {page, faults} = await openPage(browser, `${scanner.url}#calibrate`);
  await page.locator('#overlay [data-line=axis][d]').waitFor({state: 'attached'});
  const [before, from] = [await axisLine(page), (await ask(scanner, 'calibration')).platform_from_sensor];
  await page.getByRole('button', {name: 'Higher, Z'}).press('Enter');
  await page.waitForFunction((line) => document.querySelector('#overlay [data-line=axis]').getAttribute('d') !== line, before);
  assert.deepEqual((await ask(scanner, 'calibration')).platform_from_sensor, from, 'nothing is stored by a step');
  const moved = await axisLine(page);
  const {asked, answer} = await holdCalibration(page);
  await page.getByRole('button', {name: 'Keep', exact: true}).press('Enter');
  await asked;
  await nextPicture(page);
  assert.equal(await axisLine(page), moved, 'the kept pose is shown before the scanner tells it');
  answer();
  await page.getByText(/^Set by hand/).first().waitFor();
  assert.ok(Math.abs((await ask(scanner, 'calibration')).platform_from_sensor[2][3] - from[2][3] - 0.001) < 1e-6);
  await page.getByRole('button', {name: 'Undo the last change'}).press('Enter');
  await page.waitForFunction((line) => document.querySelector('#overlay [data-line=axis]').getAttribute('d') === line, before);
  assert.deepEqual((await ask(scanner, 'calibration')).platform_from_sensor, from);
  assert.deepEqual(faults, []);
  await page.unrouteAll({behavior: 'ignoreErrors'});  // a request may be pending
  await page.context().close();
}

/** Drags the top of the scanned space down, and saves it. */
async function dragSpace(scanner, browser) {
  const {page, faults} = await openPage(browser, `${scanner.url}#calibrate`);
  const top = page.getByLabel('Space upwards, to');
  await page.waitForFunction(() => document.querySelector('#space [data-clip="5"]')?.value === '400');
  await page.locator('#overlay [data-line=box][d]').waitFor({state: 'attached'});
  const plan = await page.evaluate(() => {
    const canvas = document.getElementById('plan-side');
    canvas.scrollIntoView({block: 'center'});
    const {left, top} = canvas.getBoundingClientRect();
    return {left, top, width: canvas.clientWidth, height: canvas.clientHeight};
  });
  const [right, up] = planOf(fromSide, [-140, -140, 5, 140, 140, 400], 150, plan.width, plan.height).toPixel(0, 400);
  const [x, y] = [plan.left + right, plan.top + up];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y + 40, {steps: 4});
  await page.mouse.up();
  const dragged = Number(await top.inputValue());
  assert.ok(dragged < 390 && dragged > 100, `dragged to ${dragged}`);
  await page.getByRole('button', {name: 'Keep the space'}).click();
  await page.getByRole('button', {name: 'Keep the space'}).waitFor({state: 'hidden'});
  assert.equal((await ask(scanner, 'settings')).defaults.clip_mm[5], dragged);
  assert.deepEqual(faults, []);
  await page.context().close();
}

/** Drags the right side of the scanned space inwards in the live picture, and moves it back. */
async function dragHandle(scanner, browser) {
  const {page, faults} = await openPage(browser, `${scanner.url}#calibrate`);
  const right = page.getByLabel('Space to the right, to');
  const handle = page.locator('#overlay [data-side="3"]');
  await page.waitForFunction(() => document.querySelector('#space [data-clip="3"]')?.value === '140');
  // While parts of the page are still loading, the layout may move the handle away from the pointer.
  for (let tries = 0; tries < 5 && await right.inputValue() === '140'; ++tries) {
    await handle.hover();
    const {x, y, width, height} = await handle.boundingBox();
    await page.mouse.down();
    await page.mouse.move(x + width / 2 - 25, y + height / 2, {steps: 4});
    await page.mouse.up();
  }
  const dragged = Number(await right.inputValue());
  assert.ok(dragged < 135 && dragged > 60, `dragged to ${dragged}`);
  await page.locator('#space-discard').click();
  assert.equal(await right.inputValue(), '140');
  assert.deepEqual(faults, []);
  await page.context().close();
}

/** One known length sets the scale; a wrong one is refused with its reason. */
async function setScale(scanner, browser) {
  const {page} = await openPage(browser, `${scanner.url}#calibrate`);
  await page.getByLabel('Length on the model, mm').fill('100');
  await page.getByLabel('Length by calipers, mm').fill('115');
  await page.getByRole('button', {name: 'Set the scale'}).click();
  await page.getByText(/more than a sensor can be off by/).waitFor();
  await page.getByLabel('Length by calipers, mm').fill('101.2');
  await page.getByRole('button', {name: 'Set the scale'}).click();
  await page.getByText('Models are made 1.20% larger than the sensor tells.').waitFor();
  assert.equal((await ask(scanner, 'calibration')).scale, 1.012);
  assert.equal(await page.getByLabel('Length on the model, mm').inputValue(), '', 'the lengths are used up');
  await page.getByLabel('Length on the model, mm', {exact: true}).fill('90.9');
  await page.getByLabel('Length by calipers, mm', {exact: true}).fill('90');
  await page.getByRole('button', {name: 'Add a length'}).click();
  await page.getByLabel('Length on the model, mm (2)').fill('60.6');
  await page.getByLabel('Length by calipers, mm (2)').fill('60');
  await page.getByText('The model is off by 0.75 mm on average, and by 0.90 mm at most.').waitFor();
  await page.context().close();
}

test('pose, space and scale are set on the page', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  await t.test('the pose by hand and keyboard, with the lines in the picture', () => setByHand(scanner, browser));
  await t.test('the scanned space by dragging its sides', () => dragSpace(scanner, browser));
  await t.test('the scanned space by its handles in the live picture', () => dragHandle(scanner, browser));
  await t.test('the scale by one known length', () => setScale(scanner, browser));
});
