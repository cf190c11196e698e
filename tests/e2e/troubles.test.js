// The accessibility of the page when something goes wrong.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {testedScreens, walk} from './access.js';
import {goTo, openBrowser} from './browser.js';
import {ask, startScanner} from './scanner.js';

const longScan = {snapshots: 200, leaf_size_mm: 8, filter: 'basic'};

/** Starts a scan, and waits until the page follows it. */
async function begin(scanner, page) {
  const {id} = await ask(scanner, 'scans', 'POST', longScan);
  await page.goto(`${scanner.url}#${id}`);
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await page.waitForFunction(() => Number(document.getElementById('dial-done').textContent) >= 1);
  return id;
}

/** States of scans that were stopped, by a person or by a power cut. */
const stopped = (scanner) => ({
  paused: async (page) => {
    await ask(scanner, `scans/${await begin(scanner, page)}/pause`, 'POST');
    await page.getByText('Scan paused', {exact: true}).waitFor();
  },
  binned: async (page) => {
    const {scans} = await ask(scanner, 'scans');
    await ask(scanner, `scans/${scans[0].id}`, 'DELETE');
    await goTo(page, 'Library');
    await page.getByText(/^Bin \(\d+\)$/).click();
  },
  emptying: (page) => page.getByRole('button', {name: 'Empty the bin'}).click(),
  away: async (page) => {
    await page.keyboard.press('Escape');
    await begin(scanner, page);
    await scanner.end('SIGKILL');
    await page.getByRole('alert').filter({hasText: 'The scanner does not answer'}).waitFor();
  },
  interrupted: async (page) => {
    await scanner.restart();
    await page.locator('#away').waitFor({state: 'hidden'});
    await page.getByText('Scan interrupted', {exact: true}).waitFor();
  },
});

/** States of a scanner whose sensor has frames for one stop of the next scan, and then none. */
const failing = (scanner) => ({
  trying: async (page) => {
    await ask(scanner, 'scans', 'POST', longScan);
    await page.locator('#left').getByText(/^pauses in/).waitFor();
    await page.locator('#trying').waitFor();
  },
  'given-up': async (page) => {
    await page.getByText('Scan paused', {exact: true}).waitFor();
    await page.getByText(/resume the scan/).waitFor();
  },
});

const withoutSensor = {
  'no-sensor': (page) => page.getByText(/no sensor|is not there|cannot be/i).first().waitFor(),
  'no-sensor-checked': async (page) => {
    await goTo(page, 'Scanner');
    await page.getByRole('button', {name: 'Check now'}).click();
    await page.locator('.finding').first().waitFor();
  },
};

test('a page that tells of trouble is for everyone', async (t) => {
  const browser = await openBrowser(t);
  const scanner = await startScanner(t);
  const onePicture = join(scanner.data, 'one-picture');
  await promisify(execFile)(process.env.OCTURN_PROGRAM,
      ['record', '--simulate', '--simulate-speed', '20', '-o', onePicture, '--snapshots', '1', '--frames', '1']);
  const blind = await startScanner(t, {rig: ['--simulate', '--sensor', '/nowhere.oni']});
  for (const [screen, colorScheme] of testedScreens) {
    await t.test(`stopped scans, ${screen}, ${colorScheme}`, () => walk(browser, scanner.url, stopped(scanner), screen, colorScheme));
    const failed = await startScanner(t, {rig: ['--simulate', '--sensor', onePicture]});
    await t.test(`a sensor that fails, ${screen}, ${colorScheme}`, () => walk(browser, failed.url, failing(failed), screen, colorScheme));
    await t.test(`no sensor, ${screen}, ${colorScheme}`, () => walk(browser, blind.url, withoutSensor, screen, colorScheme));
  }
  assert.equal((await ask(blind, 'status')).sensor.state, 'missing');
});
