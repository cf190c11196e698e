import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';

import {overflow} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {ask, startScanner} from './scanner.js';

const button = (page) => page.getByRole('button', {name: 'Check now'});
const line = (page, name) => page.locator('.finding').filter({has: page.getByText(name, {exact: true})});

/** Checks the simulated rig by keyboard alone. */
async function checkByKeyboard(scanner, browser) {
  const {page, faults} = await openPage(browser, `${scanner.url}#scanner`);
  await button(page).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('progressbar', {name: 'Checking'}).waitFor();
  await line(page, 'Sensor').waitFor();
  assert.ok(await page.getByRole('progressbar', {name: 'Checking'}).isHidden());
  assert.match(await line(page, 'Sensor').innerText(), /OK\s+Kinect v1 \(simulated\), 640 × 480/);
  assert.match(await line(page, 'Depth noise').innerText(), /\d\.\d\d\smm on the platform/);
  assert.ok(await button(page).evaluate((one) => one === document.activeElement));
  assert.deepEqual(faults, []);
  await page.context().close();
}

/** Checks a scanner without a sensor, on one screen. */
async function checkBrokenOne(scanner, browser, screen) {
  const {page} = await openPage(browser, `${scanner.url}#scanner`, {screen});
  await button(page).click();
  await line(page, 'Sensor').waitFor();
  assert.match(await line(page, 'Sensor').innerText(), /Fault[^]*power supply/);
  assert.match(await page.locator('#doctor-summary').innerText(), /\d faults? .*found/);
  const tooWide = await overflow(page);
  assert.ok(tooWide <= 0, `${tooWide} pixels too wide`);
  await page.locator('.doctor').scrollIntoViewIfNeeded();
  await picture(page, `check-faults-${screen}`);
  await page.context().close();
}

/** For a platform higher than configured, the finding's button starts a calibration turn, which finds its height. */
async function measurePlatform(scanner, browser) {
  const {platform_from_sensor: pose} = await ask(scanner, 'calibration');
  await ask(scanner, 'calibration', 'PATCH', {platform_from_sensor: pose.map((row, i) => i === 2 ? [...row.slice(0, 3), row[3] + 0.008] : row)});
  const {page, faults} = await openPage(browser, `${scanner.url}#scanner`);
  await button(page).click();
  assert.match(await line(page, 'Platform').innerText(), /\d+\.\d\smm above where the calibration has it and (level|tilted by \d\.\d degrees)/);
  await page.locator('.doctor').scrollIntoViewIfNeeded();
  await picture(page, 'check-platform');
  await line(page, 'Platform').getByRole('button', {name: 'Measure with a turn'}).click();
  await page.getByRole('progressbar', {name: 'Measuring with a turn'}).waitFor();
  assert.equal((await ask(scanner, 'calibration')).run.kind, 'turn');
  await ask(scanner, 'calibration/cancel', 'POST');
  assert.deepEqual(faults, []);
}

/** A place says that it is being loaded, and shows no button, until the module with the handlers has come. */
async function arriveSlowly(scanner, browser) {
  const {page, faults} = await openPage(browser, scanner.url);
  const style = page.waitForResponse('**/assets/doctor-*.css').then((response) => response.finished());
  let release = () => {};
  const released = new Promise((done) => { release = () => done(null); });
  await page.route('**/assets/scanner_page-*.js', async (route) => {
    await released;
    await route.continue();
  });
  await page.getByRole('navigation').getByRole('link', {name: 'Scanner', exact: true}).click();
  await style;
  await page.waitForTimeout(300);  // a button that is shown too early appears within this time
  assert.ok(await page.locator('#doctor[aria-busy=true]').isVisible());
  assert.ok(await button(page).isHidden());
  release();
  await button(page).click();
  await line(page, 'Sensor').waitFor();
  assert.deepEqual(faults, []);
  await page.context().close();
}

/** During a scan, checks that would disturb it are skipped. */
async function checkDuringScan(scanner, browser) {
  const {id} = await ask(scanner, 'scans', 'POST', {snapshots: 200, frames: 30, leaf_size_mm: 8});
  const {page} = await openPage(browser, `${scanner.url}#scanner`);
  await button(page).click();
  await line(page, 'Sensor').waitFor();
  assert.match(await line(page, 'Sensor').innerText(), /Not known[^]*a scan is running/i);
  assert.equal((await ask(scanner, 'status')).scan.id, id);
  await ask(scanner, `scans/${id}/cancel`, 'POST');
  await page.context().close();
}

/** The link downloads the zip file under its name and keeps the page open. */
async function downloadDiagnostics(scanner, browser) {
  const {page, faults} = await openPage(browser, `${scanner.url}#scanner`);
  const link = page.getByRole('link', {name: 'Download diagnostics'});
  const [arrived] = await Promise.all([page.waitForEvent('download'), link.click()]);
  assert.match(arrived.suggestedFilename(), /^octurn-diagnostics-\d{8}-\d{6}\.zip$/);
  const content = await readFile(await arrived.path());
  assert.equal(content.toString('latin1', 0, 4), 'PK\x03\x04');
  for (const name of ['versions.json', 'doctor.json', 'log.txt']) {
    assert.ok(content.includes(name), name);
  }
  assert.ok(await button(page).isVisible());
  assert.deepEqual(faults, []);
  await page.context().close();
}

test('the scanner is checked on the page', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  await t.test('by the keyboard alone, with progress and focus kept', () => checkByKeyboard(scanner, browser));
  await t.test('not before it can answer a click', () => arriveSlowly(scanner, browser));
  await t.test('diagnostics are a file to download', () => downloadDiagnostics(scanner, browser));
  await t.test('a scan is not disturbed', () => checkDuringScan(scanner, browser));
});

test('a finding has the button that cures it', async (t) => {
  const scanner = await startScanner(t); // a faster turn could end before the browser shows it
  await measurePlatform(scanner, await openBrowser(t));
});

test('a scanner without a sensor says what to do', async (t) => {
  const scanner = await startScanner(t, {rig: ['--sensor', 'kinect://7']});
  const browser = await openBrowser(t);
  for (const screen of ['desktop', 'phone']) {
    await t.test(`on a ${screen}`, () => checkBrokenOne(scanner, browser, screen));
  }
});
