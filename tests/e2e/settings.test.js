import assert from 'node:assert/strict';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';

import {overflow} from './access.js';
import {goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, startScanner} from './scanner.js';

async function openSettings(browser, scanner, options) {
  await Promise.all(browser.contexts().map((context) => context.close()));  // the number of event streams is limited
  const opened = await openPage(browser, scanner.url, options);
  await goTo(opened.page, 'Settings');
  await opened.page.locator('#cards').waitFor();
  return opened;
}

const card = (page, label) => page.locator('form[data-card]').filter({has: page.getByLabel(label)});
const save = (page, label) => card(page, label).getByRole('button', {name: 'Save'});

/** The settings once none needs a restart; during a restart the scanner does not answer. */
async function settled(scanner) {
  for (;;) {
    const now = await ask(scanner, 'settings').catch(() => null);
    if (now?.restart_needed.length === 0) {
      return now;
    }
    await new Promise((done) => {
      setTimeout(done, 50);
    });
  }
}

// Set elsewhere on the page, or not on the page: where data and the password are stored.
const setElsewhere = ['data', 'password_file', 'scan.depth_scale', 'scan.platform_from_sensor'];

const keysOf = ({properties}) => Object.entries(properties).flatMap(([key, schema]) =>
  schema.properties ? keysOf(schema).map((inner) => `${key}.${inner}`) : [key]);

/** Every setting of the scanner is on the page. */
async function haveTheirPlace(scanner, browser) {
  const {page, faults} = await openSettings(browser, scanner);
  const onPage = await page.locator('[data-setting]').evaluateAll((fields) => fields.map((field) => field.dataset.setting));
  const {settings_schema: schema} = await ask(scanner, 'settings');
  assert.deepEqual([...onPage, ...setElsewhere].sort(), keysOf(schema).sort());
  assert.deepEqual(faults, []);
}

/** A default for scans is in the form of a new scan at once, and still after a restart. */
async function keepScanDefault(scanner, browser) {
  const {page, faults} = await openSettings(browser, scanner);
  assert.equal(await save(page, 'Snapshots per turn').isVisible(), false);
  assert.match(await page.getByLabel('Memory').inputValue(), /^\d+$/);  // half of the machine's, in whole MB
  await card(page, 'Snapshots per turn').getByLabel('Snapshots per turn').fill('12');
  await save(page, 'Snapshots per turn').click();
  await page.getByText('Saved.', {exact: true}).waitFor();
  assert.equal((await ask(scanner, 'settings')).defaults.snapshots, 12);
  assert.deepEqual(faults, []);
  await scanner.end('SIGKILL');
  await scanner.restart();
  const {page: next} = await openPage(browser, scanner.url);
  assert.equal(await next.locator('#snapshots').inputValue(), '12');
}

/** A wrong value is reported beside its field, by the browser or by the scanner, and changes nothing. */
async function refuseByField(scanner, browser) {
  const {page} = await openSettings(browser, scanner);
  await page.getByLabel('Gear ratio').fill('0');
  await save(page, 'Gear ratio').click();
  const field = page.locator('[data-setting="turntable.gear_ratio"]');
  await field.getByText('It must be between 0.001 and 1000.').waitFor();
  await page.getByLabel('Gear ratio').fill('1');
  await page.getByLabel('Take-up of play').fill('801');  // more than a turn, which only the scanner can know
  await save(page, 'Gear ratio').click();
  await page.locator('[data-setting="turntable.take_up_steps"]').getByText('a whole number from 0 to 800').waitFor();
  assert.deepEqual((await ask(scanner, 'settings')).stored.turntable, undefined);
}

/** A change of the turntable's gear: the scanner restarts by itself, and the page goes on. */
async function takeUpGear(scanner, browser) {
  const {page} = await openSettings(browser, scanner);
  await page.getByLabel('Gear ratio').fill('3');
  await save(page, 'Gear ratio').click();
  await page.getByText('The platform makes a turn of 2400 steps.').waitFor();
  assert.equal((await settled(scanner)).settings.turntable.gear_ratio, 3);
  await page.locator('#settings-restart').waitFor({state: 'hidden'});
  await page.getByRole('button', {name: 'Back to 1', exact: true}).click();
  await page.getByText('The platform makes a turn of 800 steps.').waitFor();
  assert.deepEqual((await settled(scanner)).stored.turntable, undefined);
}

/** Downloaded settings can be restored. */
async function backUp(scanner, browser) {
  const {page} = await openSettings(browser, scanner);
  const [file] = await Promise.all([page.waitForEvent('download'), page.locator('#backup').click()]);
  assert.match(file.suggestedFilename(), /^octurn-settings-.*\.json$/);
  const backup = JSON.parse(await readFile(await file.path(), 'utf8'));
  const changed = join(scanner.data, 'backup.json');
  await writeFile(changed, JSON.stringify({...backup, settings: {scan: {snapshots: 20}}}));
  await page.locator('#restore-file').setInputFiles(changed);
  await page.getByText('Restored.').waitFor();
  assert.deepEqual((await ask(scanner, 'settings')).stored, {scan: {snapshots: 20}});
  await writeFile(changed, '{}');
  await page.locator('#restore-file').setInputFiles(changed);
  await page.getByText('Choose a file octurn-settings').waitFor();
}

/** The page shows the sensor's pose in force, not the one in the settings. */
async function tellPoseInForce(scanner, browser) {
  const {platform_from_sensor} = await ask(scanner, 'calibration');
  platform_from_sensor[2][3] += 0.011;
  const {page} = await openSettings(browser, scanner);
  await page.getByText('360 mm above its surface').waitFor();
  await page.getByText('Taken from the drawing.').waitFor();
  const change = (pose) => fetch(new URL('api/v1/calibration', scanner.url), {
    method: 'PATCH', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({platform_from_sensor: pose})});
  assert.ok((await change(platform_from_sensor)).ok);
  await goTo(page, 'Scan');
  await goTo(page, 'Settings');
  await page.getByText('371 mm above its surface').waitFor();
  await page.getByText(/^Set by hand, /).waitFor();
}

/** Nothing is cut off on this screen. */
async function fits(scanner, browser, screen, colorScheme) {
  const {page, faults} = await openSettings(browser, scanner, {screen, colorScheme});
  const tooWide = await overflow(page);
  assert.ok(tooWide <= 0, `${tooWide} pixels too wide`);
  const middles = await page.locator('.secret:visible').evaluateAll((fields) => fields.map((field) =>
    [...field.children].map((part) => part.getBoundingClientRect()).map(({top, height}) => top + height / 2)));
  assert.ok(middles.length > 0 && middles.every(([field, button]) => Math.abs(field - button) < 2),
      `Show stands beside its field: ${middles}`);
  await picture(page, `settings-${screen}-${colorScheme}`);
  assert.deepEqual(faults, []);
}

/** Holds the answers of the turntable's interface with this method. @returns the release, after which all of them pass */
async function holdAnswers(page, method) {
  let release;
  const released = new Promise((done) => {
    release = done;
  });
  await page.route('**/api/v1/turntable', async (route) => {
    if (route.request().method() !== method) {
      return route.fallback();
    }
    const response = await route.fetch();
    await released;
    return route.fulfill({response});
  });
  return release;
}

/** The user of a PrusaLink printer is asked for, as it may not be maker. */
async function addPrinter(browser, scanner) {
  const {page} = await openSettings(browser, scanner);
  await page.getByLabel('Software', {exact: true}).selectOption('prusalink');
  const values = {"Printer's name": 'MK4', "Printer's address": 'http://127.0.0.1:9', 'User': 'jane', 'API key': 'a key'};
  for (const [label, value] of Object.entries(values)) {
    await page.getByLabel(label, {exact: true}).fill(value);
  }
  const isSent = (/** @type {any} */ one) => one.method() === 'POST' && one.url().endsWith('/api/v1/printers');
  const button = page.getByRole('button', {name: 'Add the printer'});
  const [request] = await Promise.all([page.waitForRequest(isSent), button.click()]);
  assert.deepEqual(request.postDataJSON(),
      {name: 'MK4', kind: 'prusalink', url: 'http://127.0.0.1:9', user: 'jane', key: 'a key'});
  await page.context().close();
}

/** Both columns of a plain machine's settings end at about the same height. */
async function compareColumns(browser, scanner) {
  const {page} = await openSettings(browser, scanner);
  await page.locator('#messages').waitFor();
  await page.getByRole('heading', {name: 'Printers'}).waitFor();
  const ends = await page.evaluate(() => {
    const columns = new Map();
    for (const card of document.querySelectorAll('.setting-card')) {
      const {left, bottom, height} = card.getBoundingClientRect();
      height > 0 && columns.set(left, Math.max(columns.get(left) ?? 0, bottom));
    }
    return [...columns.values()];
  });
  assert.equal(ends.length, 2);
  assert.ok(Math.abs(ends[0] - ends[1]) < 300, `${ends}`);
  await page.context().close();
}

/** A theme holds for this browser, whatever the system has, and in the help, too. */
async function chooseTheme(browser, scanner) {
  const {page, faults} = await openSettings(browser, scanner);
  const shown = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
  const light = await shown();
  const fallbacks = await page.evaluate(() => [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules])
      .filter((rule) => rule instanceof CSSSupportsRule && rule.conditionText.includes('light-dark')).length);
  assert.equal(fallbacks, 1, 'for browsers without light-dark()');
  await page.getByLabel('Theme', {exact: true}).selectOption('dark');
  await page.locator('#cards').waitFor();
  const dark = await shown();
  assert.notEqual(dark, light);
  assert.equal(await page.getByLabel('Theme', {exact: true}).inputValue(), 'dark');
  await picture(page, 'settings-theme-dark');
  await page.goto(`${scanner.url}help/guide.html`);
  assert.equal(await shown(), dark);
  await page.goto(`${scanner.url}#settings`);
  await page.locator('#cards').waitFor();
  await page.getByLabel('Theme', {exact: true}).selectOption('');
  assert.equal(await shown(), light);
  assert.deepEqual(faults, []);
  await page.context().close();
}

test('the turntable gets one command at a time, however late the answers come', async (t) => {
  const scanner = await startScanner(t);  // a test of the turntable lasts longer than a busy browser takes
  const {page} = await openPage(await openBrowser(t, {hasWebGl: false}), scanner.url);
  const answered = (method) => page.waitForResponse((response) =>
    response.url().endsWith('/turntable') && response.request().method() === method);
  const testButton = page.getByRole('button', {name: 'Test a turn'});
  const isDisabled = async () => await testButton.getAttribute('aria-disabled') === 'true';

  // The state before the first command is answered after it.
  const answerState = await holdAnswers(page, 'GET');
  await goTo(page, 'Settings');
  await Promise.all([answered('POST'), testButton.click()]);
  await page.getByText('Turning and looking').waitFor();
  const [state] = await Promise.all([answered('GET'), answerState()]);
  await state.finished();
  assert.ok(await isDisabled(), 'its state of before the test is not shown');
  await page.getByRole('button', {name: 'Stop', exact: true}).click();
  await page.getByText('The test was stopped.').waitFor();

  const answerCommand = await holdAnswers(page, 'POST');
  await page.getByRole('button', {name: '10 degrees counter-clockwise'}).click();
  assert.ok(await isDisabled(), 'no other command while one is sent');
  await Promise.all([answered('POST'), answerCommand()]);
  await testButton.and(page.locator('[aria-disabled=false]')).waitFor();
});

test('a test of the turntable tells what is set wrongly, and sets it', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '20', '--simulate-gear', '1.5', '--simulate-reversed']});
  const browser = await openBrowser(t, {hasWebGl: false});
  const {page, faults} = await openSettings(browser, scanner);
  await page.getByRole('button', {name: '10 degrees counter-clockwise'}).click();
  await page.getByRole('button', {name: 'Test a turn'}).and(page.locator('[aria-disabled=false]')).click();
  await page.getByText('The turntable does not turn as configured.').waitFor();
  await picture(page, 'settings-turn');
  await page.getByRole('button', {name: /^Set Gear ratio to 1\.(5|49|50)/}).click();
  await page.getByRole('button', {name: 'Set Turn the other way to on'}).click();
  await page.getByText('It is set. Test again.').nth(1).waitFor();
  const {settings} = await settled(scanner);
  assert.ok(Math.abs(settings.turntable.gear_ratio - 1.5) < 0.01, `${settings.turntable.gear_ratio}`);
  assert.ok(settings.turntable.reversed);
  assert.deepEqual(faults.filter((fault) => !/Failed to load|ERR_/.test(fault)), []);  // failed requests during the restart
});

test('settings are set on the page and last', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t, {hasWebGl: false});
  await t.test('each of them', () => haveTheirPlace(scanner, browser));
  await t.test('in two columns that end together', () => compareColumns(browser, scanner));
  await t.test('a theme, for this browser', () => chooseTheme(browser, scanner));
  await t.test('the user of a printer', () => addPrinter(browser, scanner));
  await t.test('a default of scans', () => keepScanDefault(scanner, browser));
  await t.test('a wrong one is told by its field', () => refuseByField(scanner, browser));
  await t.test('one that needs a restart', () => takeUpGear(scanner, browser));
  await t.test('a backup', () => backUp(scanner, browser));
  await t.test('and beside them the pose in force', () => tellPoseInForce(scanner, browser));
  await t.test('on a desktop', () => fits(scanner, browser, 'desktop', 'light'));
  await t.test('on a phone', () => fits(scanner, browser, 'phone', 'dark'));
});
