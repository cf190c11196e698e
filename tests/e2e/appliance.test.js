// WiFi and updates, from the page to the request files for the appliance's root services. The test plays those services.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {mkdir, mkdtemp, readdir, readFile, rename, rm, stat, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {complaints, overflow} from './access.js';
import {goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, startScanner} from './scanner.js';

const networks = [
  'bssid / frequency / signal level / flags / ssid',
  '02:00:00:00:00:01\t2412\t-48\t[WPA2-PSK-CCMP][ESS]\tHome',
  '02:00:00:00:00:02\t2437\t-63\t[WPA2-PSK-CCMP][ESS]\tCaf\\xc3\\xa9 am Eck',
  '02:00:00:00:00:03\t2462\t-71\t[ESS]\tGuests',
  '02:00:00:00:00:04\t2462\t-82\t[WPA2-PSK-CCMP][ESS]\tThe neighbours with a long name',
].join('\n');

const pause = () => new Promise((done) => {
  setTimeout(done, 50);
});

/** An appliance: a scanner, and its root services. It runs in real time, as a faster one would only draw more previews. */
async function startAppliance(t) {
  const folder = await mkdtemp(join(tmpdir(), 'octurn-appliance-'));
  t.after(() => rm(folder, {recursive: true, force: true}));
  await mkdir(join(folder, 'requests'));
  const scanner = await startScanner(t, {rig: ['--simulate', '--appliance', folder]});
  // The page sends its time (request "control") to a machine without a clock, as in a sandbox, at any moment. Nobody here takes it.
  const requests = async () => (await readdir(join(folder, 'requests'))).filter((name) => name !== 'control');
  return {
    ...scanner,
    answer: async (name, settings) => {
      const text = typeof settings === 'string' ? settings : Object.entries(settings).map(([key, value]) => `${key} = ${value}`).join('\n');
      await writeFile(join(folder, '.new'), `${text}\n`);
      await rename(join(folder, '.new'), join(folder, name));
    },
    hasRequests: async () => (await requests()).length > 0,
    /** Waits for a request, and takes it away. */
    take: async (name) => {
      const file = join(folder, 'requests', name);
      while (!(await requests()).includes(name)) {
        await pause();
      }
      const content = await readFile(file);
      assert.equal((await stat(file)).mode & 0o777, 0o600);
      await rm(file);
      assert.deepEqual(await requests(), []);
      return content;
    },
  };
}

/** A file of that size to upload. The browser gets its name instead of its bytes, which is faster. */
async function bundle(appliance, bytes) {
  const file = join(appliance.data, 'octurn.update');
  const content = Buffer.alloc(bytes, 'octurn ');
  await writeFile(file, content);
  return {file, content};
}

/** This state of the page is accessible, and it fits the screen. */
async function look(page, name) {
  assert.deepEqual(await complaints(page), [], name);
  assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
  await picture(page, name);
}

/** Decodes the QR code on the page from a screenshot. */
async function readCode(page, wifi) {
  const folder = await mkdtemp(join(tmpdir(), 'octurn-code-'));
  const file = join(folder, 'code.png');
  await wifi.locator('#wifi-code svg').screenshot({path: file});
  const {stdout} = await promisify(execFile)('zbarimg', ['--quiet', '--raw', file]);
  await rm(folder, {recursive: true});
  return stdout;
}

/** The chosen network can be told from the others in forced colours. */
async function lookInForcedColours(page, wifi, screen) {
  await page.emulateMedia({forcedColors: 'active'});
  const outlines = await wifi.locator('.network').evaluateAll((labels) =>
    labels.map((label) => `${label.querySelector('.network-name').textContent} ${getComputedStyle(label).outlineStyle}`));
  assert.deepEqual(outlines.filter((outline) => !outline.endsWith(' none')), ['Guests solid']);
  await picture(page, `wifi-${screen}-forced`);
  await page.emulateMedia({forcedColors: 'none'});
}

const firstSection = (page) => page.evaluate(() => document.getElementById('main').firstElementChild.id);

async function joinWifi(appliance, browser, screen, colorScheme) {
  await appliance.answer('networks', networks);
  await appliance.answer('wifi', {state: 'hotspot', country: 'DE', hotspot: 'Octurn-1A2B'});
  const {page, faults} = await openPage(browser, appliance.url, {screen, colorScheme});
  const wifi = page.getByRole('region', {name: 'WiFi'});
  await wifi.getByText('The scanner has a WiFi of its own, “Octurn-1A2B”').waitFor();
  assert.equal(await firstSection(page), 'wifi', 'it comes first');
  assert.deepEqual(await wifi.locator('.network-name').allInnerTexts(),
      ['Home', 'Café am Eck', 'Guests', 'The neighbours with a long name', 'Another, by its name']);
  await look(page, `wifi-hotspot-${screen}`);
  assert.equal(await readCode(page, wifi), 'WIFI:T:nopass;S:Octurn-1A2B;;\n');

  await wifi.getByRole('radio', {name: /^Guests open, 2 of 4/}).check();
  assert.ok(await wifi.getByLabel('Password', {exact: true}).isHidden());
  await lookInForcedColours(page, wifi, screen);
  await wifi.getByRole('radio', {name: /^Home with a password, 4 of 4/}).check();
  assert.equal(await wifi.getByLabel('Country').inputValue(), 'DE');
  await wifi.getByLabel('Password', {exact: true}).fill('short');
  await wifi.getByRole('button', {name: 'Join'}).click();
  assert.ok(await wifi.getByLabel('Password', {exact: true}).evaluate((field) => field.matches(':user-invalid')));
  assert.equal(await appliance.hasRequests(), false);
  await wifi.getByLabel('Password', {exact: true}).fill('open;"sesame"');
  await wifi.getByRole('button', {name: 'Show the password'}).click();
  assert.equal(await wifi.getByLabel('Password', {exact: true}).getAttribute('type'), 'text');
  await look(page, `wifi-chosen-${screen}`);
  await wifi.getByRole('button', {name: 'Join'}).click();
  await wifi.getByText('Joining “Home”…').waitFor();
  assert.match(await wifi.locator('#wifi-joining').innerText(), /Connect this device to “Home”, too, and open http:\/\/.+\.local/);
  assert.equal(await readCode(page, wifi), String.raw`WIFI:T:WPA;S:Home;P:open\;\"sesame\";;` + '\n');
  assert.equal(String(await appliance.take('wifi')), 'wifi_name = Home\nwifi_password = open;"sesame"\nwifi_country = DE\n');
  await look(page, `wifi-joining-${screen}`);

  await appliance.answer('wifi', {state: 'hotspot', name: 'Home', country: 'DE', hotspot: 'Octurn-1A2B', error: 'The password is wrong.'});
  await wifi.getByRole('alert').filter({hasText: '“Home” could not be joined'}).waitFor();
  assert.ok(await wifi.getByRole('radio', {name: /^Home/}).isChecked());
  await look(page, `wifi-failed-${screen}`);

  await wifi.getByRole('radio', {name: 'Another, by its name'}).check();
  await wifi.getByLabel('Name of the WiFi').fill('Workshop');
  await wifi.getByLabel('Country').selectOption('AT');
  await wifi.getByRole('button', {name: 'Join'}).click();
  await wifi.getByText('Joining “Workshop”…').waitFor();
  assert.equal(String(await appliance.take('wifi')), 'wifi_name = Workshop\nwifi_country = AT\n');
  await appliance.answer('wifi', {state: 'joined', name: 'Workshop', country: 'AT'});
  await goTo(page, 'Scanner');
  await wifi.getByText('The scanner is in “Workshop”.').waitFor();
  assert.notEqual(await firstSection(page), 'wifi', 'it has gone to its place at the end');
  await look(page, `wifi-joined-${screen}`);
  await wifi.getByRole('button', {name: 'Join another WiFi'}).click();
  assert.ok(await wifi.getByRole('radio').first().isVisible());
  assert.deepEqual(faults, []);
  await page.context().close();
}

async function installUpdate(appliance, browser, screen, colorScheme) {
  const {file, content} = await bundle(appliance, 20_000_000);
  await appliance.answer('update', {slot: 'a', state: 'none'});
  await appliance.answer('wifi', {state: 'joined', name: 'Home', country: 'DE'});
  const {page} = await openPage(browser, `${appliance.url}#scanner`, {screen, colorScheme});
  const update = page.getByRole('region', {name: 'Update'});
  await update.getByText(/^Octurn .* is in use\.$/).waitFor();
  await look(page, `update-idle-${screen}`);
  await update.getByLabel(/Choose a/).setInputFiles(file);
  await update.getByText('20 MB').waitFor();
  await look(page, `update-chosen-${screen}`);
  await update.getByRole('button', {name: 'Install'}).click();
  await update.getByText('Checking and writing…').waitFor();
  await assert.rejects(ask(appliance, 'scans', 'POST', {}), /an update is being installed/);
  await look(page, `update-installing-${screen}`);

  await appliance.answer('update', {slot: 'a', state: 'failed', version: '', error: 'This is no update for this scanner.'});
  assert.ok(content.equals(await appliance.take('update')));
  await update.getByText('This is no update for this scanner. Nothing was changed.').waitFor();
  await look(page, `update-failed-${screen}`);

  await update.getByLabel(/Choose a/).setInputFiles(file);
  await update.getByRole('button', {name: 'Install'}).click();
  await update.getByText('Checking and writing…').waitFor();
  await appliance.answer('update', {slot: 'a', state: 'restarting', version: '0.2.0'});
  await appliance.take('update');
  await update.getByText('Starting again…').waitFor();
  await appliance.end();
  await page.getByRole('alert').filter({hasText: 'The scanner starts again.'}).waitFor();
  await look(page, `update-restarting-${screen}`);

  await appliance.answer('update', {slot: 'b', state: 'trial', version: '0.2.0'});
  await appliance.restart();
  await update.getByText('Trying the new version…').waitFor();
  await page.locator('#away').waitFor({state: 'hidden'});
  await page.reload();
  await appliance.answer('update', {slot: 'b', state: 'kept', version: '0.2.0'});
  await update.getByText('Octurn 0.2.0 is running').waitFor();
  await look(page, `update-kept-${screen}`);
  await appliance.answer('update', {slot: 'a', state: 'returned', version: '0.2.0', error: 'The update to 0.2.0 did not work.'});
  await update.getByText('The update to 0.2.0 did not start; the earlier version is back').waitFor();
  await look(page, `update-returned-${screen}`);
  await page.context().close();
}

/** An upload can be cancelled; the network is throttled so that there is time for it. */
async function cancelUpdate(appliance, browser) {
  await appliance.answer('update', {slot: 'a', state: 'none'});
  const {page} = await openPage(browser, `${appliance.url}#scanner`);
  const network = await page.context().newCDPSession(page);
  await network.send('Network.emulateNetworkConditions', {offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: 1e6});
  const update = page.getByRole('region', {name: 'Update'});
  await update.getByLabel('Choose a file').setInputFiles((await bundle(appliance, 40_000_000)).file);
  await update.getByRole('button', {name: 'Install'}).click();
  await update.getByText(/^[1-9].* of 40\sMB$/).waitFor();
  await look(page, 'update-sending-desktop');
  await update.getByRole('button', {name: 'Cancel'}).click();
  await update.getByRole('button', {name: 'Install'}).waitFor();
  while ((await ask(appliance, 'update')).state !== 'none') {
    await pause();
  }
  assert.equal(await appliance.hasRequests(), false);
  await page.context().close();
}

/** A page of an older version reloads when the scanner runs another one. */
async function meetNewVersion(appliance, browser) {
  const {page} = await openPage(browser, `${appliance.url}#scanner`);
  await page.locator('#update-summary').filter({hasText: 'is in use'}).waitFor();
  await page.evaluate(() => {
    globalThis.isOld = true;
  });
  await page.route('**/api/v1/update', async (route) => {
    const body = await (await route.fetch()).json();
    await route.fulfill({json: {...body, version: '9.9.9'}});
  });
  await page.waitForFunction(() => !globalThis.isOld);
  await page.getByText('Octurn 9.9.9 is in use.').waitFor();
  await page.context().close();
}

test('the appliance is updated, and joins a WiFi, by its page', async (t) => {
  const appliance = await startAppliance(t);
  const browser = await openBrowser(t, {hasWebGl: false}); // no test views a model
  for (const [screen, colorScheme] of [['phone', 'light'], ['desktop', 'dark']]) {
    await t.test(`a WiFi is joined on a ${screen}`, () => joinWifi(appliance, browser, screen, colorScheme));
    await t.test(`an update is installed on a ${screen}`, () => installUpdate(appliance, browser, screen, colorScheme));
  }
  await t.test('an update on its way is called back', () => cancelUpdate(appliance, browser));
  await t.test('a page of the version before is loaded again', () => meetNewVersion(appliance, browser));
});

test('elsewhere the page has neither', async (t) => {
  const {page, faults} = await openPage(await openBrowser(t), `${(await startScanner(t)).url}#scanner`);
  await page.getByRole('list', {name: 'Devices'}).getByText('ready').first().waitFor();
  assert.ok(await page.locator('#wifi').isHidden());
  assert.ok(await page.locator('#update').isHidden());
  assert.deepEqual(faults, []);
});
