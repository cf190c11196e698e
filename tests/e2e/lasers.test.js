// A rig with lasers on the page: a calibration turn measures it, the next scan uses the result, and a scan shows a preview.

import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';

import {complaints} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {ask, scan, scanFolders, startScanner} from './scanner.js';

const rig = ['--simulate-laser', '--simulate-speed', '20'];
const draft = {snapshots: 24, leaf_size_mm: 4, calibrate: 'told'};

const planesOf = ({lasers}) => lasers.map(({name, plane_m}) => [name, plane_m]);

test('a turn measures camera and lasers, and the next scan is told what it found', async (t) => {
  const scanner = await startScanner(t, {rig});
  const {page, faults} = await openPage(await openBrowser(t), `${scanner.url}#calibrate`);
  await page.getByText('Each scan calibrates itself').waitFor();
  for (const id of ['flatten', 'by-hand', 'known-length']) {
    assert.equal(await page.locator(`#${id}`).isVisible(), false, id);
  }
  await page.getByRole('button', {name: 'Measure with a turn'}).click();
  await page.getByText('Camera and lasers were measured').waitFor();
  await picture(page, 'lasers-measured');
  assert.deepEqual(await complaints(page), []);

  const found = await ask(scanner, 'calibration');
  assert.equal(found.source, 'turn');
  assert.equal(found.camera, 'simulated-laser');
  assert.ok(found.run.report.slice_mm.after.length > 100);
  await scan(scanner, draft);
  const [folder] = await scanFolders(scanner);
  const {sensor} = JSON.parse(await readFile(`${folder}/scan.json`, 'utf8'));
  assert.deepEqual(planesOf(sensor), planesOf(found));

  await page.locator('#undo').click();
  await page.locator('#undo').waitFor({state: 'hidden'});
  assert.equal((await ask(scanner, 'calibration')).lasers, undefined);
  assert.deepEqual(faults, []);
});

test('a scale of depths is refused', async (t) => {
  const scanner = await startScanner(t, {rig});
  await assert.rejects(ask(scanner, 'calibration', 'PATCH', {scale: 1.01}), /400 .*measures no depth/);
});

test('the live picture is the camera\'s, with no distances in it', async (t) => {
  const scanner = await startScanner(t, {rig});
  const {page} = await openPage(await openBrowser(t), scanner.url);
  await page.getByText(/^Live picture\s· /).waitFor();
  assert.equal(await page.locator('.scale').isVisible(), false);
  const drawn = await page.waitForFunction(() => {
    const canvas = /** @type {HTMLCanvasElement} */ (document.getElementById('depth'));
    const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const pixels = Array.from({length: data.length / 4}, (_, index) => data.slice(4 * index, 4 * index + 3));
    const isGrey = pixels.every(([red, green, blue]) => red === green && green === blue);
    const brightest = Math.max(...pixels.map(([red]) => red));
    return isGrey && brightest > 0 && {brightest};
  }, null, {polling: 500});
  const seen = await drawn.jsonValue();
  assert.ok(seen.brightest > 24, `nothing brighter than ${seen.brightest}`);
  await picture(page, 'lasers-live');
});

test('a scan shows a coarse surface while the platform turns', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate-laser', '--simulate-speed', '4']});
  const {page} = await openPage(await openBrowser(t), scanner.url);
  const {id} = await ask(scanner, 'scans', 'POST', draft);
  let seen = null;
  for (let state = 'running'; state === 'running' && !seen;) {
    const now = await ask(scanner, `scans/${id}`);
    state = now.state;
    seen = now.snapshots_done < draft.snapshots && now.preview?.snapshots >= draft.snapshots / 2 ? now.preview : null;
  }
  assert.ok(seen, 'no preview of half of the stops before the last one');
  const stl = await fetch(`${scanner.url}${seen.url.slice(1)}`);
  assert.equal(stl.status, 200);
  assert.ok((await stl.arrayBuffer()).byteLength > 84 + 50 * 100);
  await picture(page, 'lasers-preview');
  await ask(scanner, `scans/${id}/cancel`, 'POST', {});
});
