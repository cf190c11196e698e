import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {chooseQuickScan, openBrowser, openPage, picture} from './browser.js';
import {ask, startScanner} from './scanner.js';

test('a scan that was interrupted by the scanner\'s end is resumed on the page, and finished', async (t) => {
  const scanner = await startScanner(t);
  const {page} = await openPage(await openBrowser(t), scanner.url, {screen: 'phone'});
  const snapshots = 8;
  await chooseQuickScan(page, snapshots);
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.waitForFunction(() => Number(document.getElementById('dial-done').textContent) >= 2);
  await scanner.end('SIGKILL');
  await scanner.restart();

  await page.getByText('Scan interrupted', {exact: true}).waitFor();
  await picture(page, 'interrupted-phone');
  await page.getByRole('button', {name: 'Resume'}).click();
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await page.getByRole('link', {name: 'Download STL'}).first().waitFor();
  assert.ok(await page.getByRole('button', {name: 'Resume'}).isHidden());
  const {scans: [scan]} = await ask(scanner, 'scans');
  assert.equal(scan.state, 'finished');
  assert.equal(scan.snapshots_done, snapshots);
});

/** Who comes to a scanner with a paused scan is told of it, and its page does not call the scanner ready. */
async function meetPaused(browser, url) {
  const {page} = await openPage(browser, url);
  await page.locator('#live-hint').getByText('Ready to scan').waitFor();
  await page.locator('#unfinished').getByText(/is not finished: \d+ of 200 snapshots\./).waitFor();
  await page.getByRole('link', {name: 'Continue or end it'}).click();
  await page.getByText('Scan paused', {exact: true}).waitFor();
  assert.ok(await page.getByRole('button', {name: 'Resume'}).isVisible());
  await page.locator('#live-hint').waitFor({state: 'hidden'});
  await picture(page, 'paused-met');
  await page.context().close();
}

test('a scan is paused and resumed, ended and resumed, by a tap each', async (t) => {
  const scanner = await startScanner(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url, {screen: 'phone'});
  await chooseQuickScan(page, 200);
  await page.getByRole('button', {name: 'Start scan'}).click();
  const bar = page.getByRole('button', {name: 'Pause'});
  await page.waitForFunction(() => Number(document.getElementById('dial-done').textContent) >= 1);
  const {y, height} = await bar.boundingBox();
  assert.ok(y > 0 && y + height <= 844, `in reach of a thumb, not at ${y}`);
  await picture(page, 'progress-phone');
  await bar.click();
  await page.getByText('Scan paused', {exact: true}).waitFor();
  await meetPaused(page.context().browser(), scanner.url);
  await page.getByRole('button', {name: 'Resume'}).click();
  await page.locator('#cancel').click();
  await page.getByText('Scan ended', {exact: true}).waitFor();
  await picture(page, 'ended-phone');
  const {scans: [ended]} = await ask(scanner, 'scans');
  await page.getByRole('button', {name: 'Resume'}).click();
  await page.waitForFunction((done) => Number(document.getElementById('dial-done').textContent) > done, ended.snapshots_done);
  assert.deepEqual([ended.state, (await ask(scanner, 'status')).scan.id], ['cancelled', ended.id]);
  assert.deepEqual(faults, []);
});

test('a scan whose sensor fails pauses, says why, and can be ended with what it has', async (t) => {
  // The sensor is a recording with frames for every other stop only.
  const recordings = await startScanner(t);  // for its folder
  const turn = join(recordings.data, 'turn');
  await promisify(execFile)(process.env.OCTURN_PROGRAM,
      ['record', '--simulate', '--simulate-speed', '20', '-o', turn, '--snapshots', '2', '--frames', '1']);
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '4', '--sensor', turn]});
  const {page} = await openPage(await openBrowser(t), scanner.url);
  await chooseQuickScan(page, 4);
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.locator('#phase').getByText('Trying stop 2 of 4 again').waitFor();
  await page.locator('#left').getByText(/^pauses in \d+\ss$/).waitFor();
  await page.getByText('Scan paused', {exact: true}).waitFor();
  const trouble = await page.locator('#trouble').innerText();
  assert.match(trouble, /no frame at 90 degrees\.[^]*resume the scan/);
  assert.ok(!trouble.includes(turn), `a path is nothing to a reader: ${trouble}`);
  await picture(page, 'paused');

  await page.getByRole('button', {name: 'End scan'}).click();
  await page.getByText('Scan ended', {exact: true}).waitFor();
  assert.ok(await page.getByRole('button', {name: 'Resume'}).isVisible());
  assert.ok(await page.getByRole('button', {name: 'Build the model of 1 snapshot'}).isVisible());
});
