import assert from 'node:assert/strict';
import {test} from 'node:test';

import {openBrowser, openPage, picture} from './browser.js';
import {ask, startScanner} from './scanner.js';

test('without a sensor the page says so, and what to do', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--sensor', 'nowhere']});
  const {page} = await openPage(await openBrowser(t), scanner.url);
  const {sensor} = await ask(scanner, 'status');
  assert.notEqual(sensor.state, 'ready');
  await page.getByRole('list', {name: 'Devices'}).getByText(/not found|failed/).first().waitFor();
  const start = page.getByRole('button', {name: 'Start scan'});
  assert.equal(await start.getAttribute('aria-disabled'), 'true');
  await start.click({force: true});
  const said = (await page.locator('#faults li').first().innerText()).replace(/\.$/, '');
  await page.waitForFunction((words) => document.body.innerText.split(words).length === 2, said);  // it is said once
  await page.locator('#no-picture').getByText(/power supply/).waitFor();  // and beside it, what to do
  await picture(page, 'no-sensor');
  assert.deepEqual((await ask(scanner, 'scans')).scans, [], 'no scan was tried');

  await page.getByRole('button', {name: 'Open a demo scan'}).click();
  await page.getByText('A good model', {exact: true}).waitFor();
  assert.equal(await page.getByRole('heading', {level: 1}).innerText(), 'Demo, scanned by a simulated rig');
  const [demo] = (await ask(scanner, 'scans')).scans;
  assert.deepEqual([demo.state, demo.snapshots_done, demo.model.quality.verdict], ['finished', 16, 'good']);
  await picture(page, 'demo');
  await page.goto(scanner.url);
  const step = page.locator('[data-step=scan]');
  await step.waitFor();
  assert.equal(await step.getAttribute('data-state'), 'next', 'a demo is nobody\'s first model');
  await ask(scanner, `scans/${demo.id}`, 'DELETE');
});

test('settings that make no sense are not sent', async (t) => {
  const scanner = await startScanner(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await page.getByText('All settings').click();
  await page.getByLabel('Up, to').fill('1');  // below where the space begins
  await page.getByText('All settings').click();
  await page.getByRole('button', {name: 'Start scan'}).click();
  assert.ok(await page.getByLabel('Up, to').isVisible(), 'the field at fault is shown');
  assert.equal(await page.evaluate(() => document.activeElement?.getAttribute('aria-label')), 'Up, to');
  assert.deepEqual((await ask(scanner, 'scans')).scans, []);

  await page.getByRole('button', {name: 'Back to Standard'}).click();
  await page.getByLabel('Snapshots per turn', {exact: true}).fill('40');
  await page.getByLabel('Coarse').check();
  await page.getByLabel('Depth filter').selectOption('basic');
  await page.getByLabel('Intersection').check();
  await page.getByLabel('Widest gap bridged').fill('20');
  const another = await page.context().newPage();
  await another.goto(scanner.url);
  await another.getByText('Custom: 40 snapshots per turn · 2 mm detail').waitFor();
  await another.close();
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  const {settings} = (await ask(scanner, 'scans')).scans[0];
  assert.deepEqual({...settings, platform_from_sensor: undefined}, {
    snapshots: 40, leaf_size_mm: 2, filter: 'basic', frames: 10, method: 'intersection', max_error_mm: 0.04, parts: 'main',
    threshold_m2: 0.0004, root_size_mm: 1000, calibrate: 'auto', depth_scale: 1, clip_mm: [-140, -140, 5, 140, 140, 400], platform_from_sensor: undefined,
  });
  assert.deepEqual(faults, []);
});
