// A scan with a wrong pose, rebuilt with the pose solved from its own snapshots; and its other models.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {ask, quick, scan, startScanner} from './scanner.js';

/** The simulated sensor's pose: 0.62 m in front of the axis, 0.36 m up, pitched down by 25 degrees. */
const angle = 25 * Math.PI / 180;
const nominal = [
  [1, 0, 0, 0], [0, -Math.sin(angle), Math.cos(angle), -0.62], [0, -Math.cos(angle), -Math.sin(angle), 0.36], [0, 0, 0, 1]];

/** That pose, off by 2 cm and 2 degrees. */
function wrongPose() {
  const tilt = 2 * Math.PI / 180;
  const [c, s] = [Math.cos(tilt), Math.sin(tilt)];
  const rows = nominal.map((row) => [...row]);
  for (let column = 0; column < 4; ++column) {
    const [y, z] = [nominal[1][column], nominal[2][column]];
    [rows[1][column], rows[2][column]] = [c * y - s * z, s * y + c * z];
  }
  rows[0][3] += 0.012;
  rows[1][3] -= 0.016;
  return rows;
}

const askew = {snapshots: 24, leaf_size_mm: 1, filter: 'basic', calibrate: 'told', platform_from_sensor: wrongPose()};

/** Rebuilds a scan with a solved pose on the page, and uses its models, on one screen. */
async function straighten(scanner, browser, screen, colorScheme) {
  const made = await scan(scanner, askew);
  assert.equal(made.model.quality.verdict, 'bad');
  const {page, faults} = await openPage(browser, `${scanner.url}#${made.id}`, {screen, colorScheme});
  await page.locator('#tools').waitFor();
  const straightenButton = page.getByRole('button', {name: 'Straighten'});
  await straightenButton.waitFor();
  await picture(page, `askew-${screen}`);
  await straightenButton.click();
  await page.locator('#verdict[data-tone=good]').waitFor();
  await page.getByText('Corrected by this scan').waitFor({state: 'attached'});
  assert.ok(await straightenButton.isHidden());
  const now = await ask(scanner, `scans/${made.id}`);
  assert.deepEqual([now.build, now.model.quality.verdict], [1, 'good']);

  const rows = page.locator('#build-rows > li');
  assert.equal(await rows.count(), 2);
  assert.match(await rows.nth(1).innerText(), /Build 1[\s\S]*In use/);
  await page.locator('#tools').waitFor();
  await picture(page, `straight-${screen}`);
  assert.deepEqual(await complaints(page), []);
  assert.ok(await overflow(page) <= 0, `${await overflow(page)} pixels too wide`);

  await rows.nth(0).getByRole('button', {name: 'As scanned', exact: true}).click();
  await page.locator('#verdict:not([data-tone=good])').waitFor();
  await page.locator('#tools').waitFor();
  await picture(page, `as-scanned-${screen}`);
  return {page, faults, made, rows};
}

/** Builds another model with the form. */
async function buildAgain(scanner, {page, faults, made, rows}, screen) {
  await page.getByText('Build again', {exact: true}).click();
  const form = page.locator('#build-form');
  await form.getByLabel('Pose of the sensor').selectOption('auto');
  await form.getByLabel('Draft').check();
  await form.locator('#build-clip').getByLabel('Up, to').fill('60');
  await picture(page, `build-again-${screen}`);
  assert.deepEqual(await complaints(page), []);
  assert.ok(await overflow(page) <= 0, 'the form is too wide');
  await form.getByRole('button', {name: 'Build', exact: true}).click();
  await rows.nth(2).waitFor();
  await page.locator('#build-rows > li:nth-child(3) .build-show[aria-pressed=true]').waitFor();
  const {builds} = await ask(scanner, `scans/${made.id}/builds`);
  assert.deepEqual([builds[2].settings.leaf_size_mm, builds[2].settings.clip_mm[5], builds[2].chosen], [4, 60, false]);
  assert.ok(builds[2].model.size_mm[2] < 70);
  await page.locator('#tools').waitFor();
  await rows.nth(0).getByRole('button', {name: 'As scanned', exact: true}).click();
  await page.waitForFunction(() => document.querySelector('#build-form [data-clip="5"]').value === '400');
  assert.ok(await form.getByLabel('Medium').isChecked(), 'the form has the settings of the model in view');
  await rows.nth(2).locator('.build-show').click();
  await page.locator('#tools').waitFor();

  await rows.nth(2).getByRole('button', {name: 'Use this model'}).click();
  await rows.nth(2).getByText('In use').waitFor();
  assert.equal((await ask(scanner, `scans/${made.id}`)).build, 2);
  await rows.nth(1).getByRole('button', {name: 'Delete: Build 1'}).click();
  await page.getByRole('button', {name: 'Delete', exact: true}).click();
  await page.waitForFunction(() => document.querySelectorAll('#build-rows > li').length === 2);
  assert.deepEqual(faults, []);
  await page.context().close();
}

test('a scan with a wrong pose is straightened and built again from its page', async (t) => {
  const scanner = await startScanner(t, quick);
  const browser = await openBrowser(t);
  for (const [screen, colorScheme] of [['desktop', 'light'], ['phone', 'dark']]) {
    await t.test(`on a ${screen}`, async () => {
      await buildAgain(scanner, await straighten(scanner, browser, screen, colorScheme), screen);
    });
  }
});

test('a build that lasts shows how far it is, and is cancelled', async (t) => {
  const scanner = await startScanner(t, quick);
  const made = await scan(scanner, {snapshots: 8, leaf_size_mm: 8, filter: 'basic', method: 'intersection'});
  const {page} = await openPage(await openBrowser(t), `${scanner.url}#${made.id}`);
  await page.getByText('Build again', {exact: true}).waitFor();
  await ask(scanner, `scans/${made.id}/builds`, 'POST', {leaf_size_mm: 0.2});
  await page.getByText('Building the model', {exact: true}).waitFor();
  await page.locator('#build-cancel').click();
  await page.locator('#build-going').waitFor({state: 'hidden'});
  assert.deepEqual((await ask(scanner, `scans/${made.id}/builds`)).builds.map(({state}) => state), ['finished', 'cancelled']);
});

test('the places of a reason are marked in the picture', async (t) => {
  const scanner = await startScanner(t, quick);
  const made = await scan(scanner, {snapshots: 6, leaf_size_mm: 4, filter: 'basic'});
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, scanner.url);
  const places = Array.from({length: 200}, (_, i) => [30 + i % 10, -20 + i / 20, 120 + i % 7]);
  const withPlaces = (/** @type {any} */ {model, ...rest}) => model ? {...rest, model: {...model, quality: {verdict: 'look', reasons: [
    {code: 'moved', detail: 'this part moved', hint: 'Scan again.', places_mm: places}]}}} : {model, ...rest};
  await page.route(/api\/v1\/scans(\/[^/]+\/builds)?$/, async (route) => {
    const body = await (await route.fetch()).json();
    await route.fulfill({json: Object.fromEntries(Object.entries(body).map(([key, list]) => [key, list.map(withPlaces)]))});
  });
  await page.goto('about:blank');
  await page.goto(`${scanner.url}#${made.id}`);
  await page.locator('#tools').waitFor();
  const toggle = page.getByRole('button', {name: 'Show where'});
  const shot = () => page.locator('#view').screenshot();
  const before = await shot();
  await toggle.click();
  await page.getByRole('button', {name: 'Hide where', pressed: true}).waitFor();
  await page.waitForFunction(() => new Promise((done) => {
    requestAnimationFrame(() => requestAnimationFrame(() => done(true)));
  }));
  assert.ok(!before.equals(await shot()), 'the picture has changed');
  await picture(page, 'places');
  assert.deepEqual(faults, []);
});
