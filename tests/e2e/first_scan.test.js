import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';

import {chooseQuickScan, clickModel, modelShare, openBrowser, openPage, picture} from './browser.js';
import {measure} from '../web/mesh_file.js';
import {startScanner} from './scanner.js';

/** The number of different colours in the depth picture, and the share of its pixels with a reading. */
const depthPicture = (page) => page.locator('#depth').evaluate((canvas) => {
  const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  return {colours: new Set(pixels).size, share: pixels.filter((pixel) => pixel >>> 24 > 0).length / pixels.length};
});

/** Records each number of snapshots that the page shows. */
const noteProgress = (page) => page.evaluate(() => {
  globalThis.noted = [];
  const number = document.getElementById('dial-done');
  new MutationObserver(() => globalThis.noted.push(Number(number.textContent)))
      .observe(number, {childList: true, characterData: true, subtree: true});
});

test('a scan, from one press of Start to a whole, closed Scan.stl', async (t) => {
  // Slow enough that the page, which asks several times a second, shows more than the beginning and the end.
  const scanner = await startScanner(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  assert.equal((await fetch(scanner.url)).headers.get('Content-Security-Policy').split(';')[0], `default-src 'self'`);

  await page.locator('#no-picture').waitFor({state: 'hidden'});
  const depth = await depthPicture(page);
  assert.ok(depth.colours > 20 && depth.share > 0.5, `a depth picture, not ${JSON.stringify(depth)}`);
  await picture(page, 'idle');

  const snapshots = 12;
  await chooseQuickScan(page, snapshots);
  await noteProgress(page);
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await page.waitForFunction(() => Number(document.getElementById('dial-done').textContent) >= 2);
  assert.match(await page.title(), /^(\d+\/12|Building) · Octurn$/);
  await page.locator('#tools').waitFor();
  while (await modelShare(page) < 0.005) {
    assert.ok(await page.getByRole('progressbar', {name: 'Scan'}).isVisible(), 'what was seen so far is shown in 3D');
  }
  await picture(page, 'scanning');

  const download = page.getByRole('link', {name: 'Download STL'}).first();
  await download.waitFor();
  const noted = await page.evaluate(() => globalThis.noted);
  assert.ok(noted.length >= 3, `progress was shown in steps, not as ${noted}`);
  assert.deepEqual(noted, [...new Set(noted)].sort((a, b) => a - b), 'progress only grows');
  assert.equal(await page.title(), `${await page.locator('#details-name').innerText()} · Octurn`);

  const [arrived] = await Promise.all([page.waitForEvent('download'), download.click()]);
  assert.equal(arrived.suggestedFilename(), 'Scan.stl');
  const mesh = measure(await readFile(await arrived.path()));
  assert.equal(mesh.openEdges, 0);
  assert.ok(mesh.triangles > 1000 && mesh.volume > 0, `a solid thing, not ${JSON.stringify(mesh)}`);
  assert.ok(mesh.min[2] > -5 && mesh.max[2] < 405, 'in millimetres, on the platform, inside the scanned space');

  const facts = await page.locator('#facts').innerText();
  assert.ok(facts.includes(mesh.triangles.toLocaleString('en')), facts);
  assert.match(facts, /Watertight\s+Yes/);
  const sides = mesh.max.map((high, axis) => (high - mesh.min[axis]).toFixed(1));
  assert.equal(await page.locator('#size').innerText(), `${sides.join(' × ')}\u00a0mm`);

  await page.locator('#tools').waitFor();
  const share = await modelShare(page);
  assert.ok(share > 0.02, `a model in 3D, not ${share} of the view`);
  await picture(page, 'finished');

  await page.getByRole('button', {name: 'Measure the model'}).click();
  for (const [place, text] of [[0.3, 'Click another one.'], [0.5, /^\d+\.\d\smm \(ΔX /]]) {
    await clickModel(page, place);
    await page.locator('#measured').filter({hasText: text}).waitFor();
  }
  const distance = parseFloat(await page.locator('#measured').innerText());
  assert.ok(distance > 1 && distance < Math.hypot(...sides), `${distance} mm between two points of the model`);
  await page.getByRole('button', {name: 'Cut the model open'}).click();
  assert.equal(await page.locator('#cut-at').innerText(), `${((mesh.min[2] + mesh.max[2]) / 2).toFixed(1)}\u00a0mm`);
  const left = await modelShare(page);
  assert.ok(left < 0.9 * share, `less of the model is left than ${share}, not ${left} of the view`);
  await picture(page, 'measured');

  await page.getByRole('button', {name: 'Cut the model open'}).click();
  await page.locator('#cut-place').waitFor({state: 'hidden'});
  await page.getByRole('button', {name: 'Lay it on another side'}).click();
  await page.getByText('Click the side it should rest on.').waitFor();
  await clickModel(page, 0.5);  // on the chest
  await page.getByText('Click the side it should rest on.').waitFor({state: 'hidden'});
  const halfHeight = async () => {
    await page.getByRole('button', {name: 'Cut the model open'}).click();
    return parseFloat(await page.locator('#cut-at').innerText());
  };
  const laid = await halfHeight();
  await picture(page, 'laid');
  await page.getByRole('button', {name: 'Lay it on another side'}).click();
  const upright = await halfHeight();
  assert.equal(upright.toFixed(1), ((mesh.min[2] + mesh.max[2]) / 2).toFixed(1), 'as it was scanned');
  assert.ok(laid < 0.5 * upright, `on its front it is lower than on its feet: ${2 * laid} mm, not ${2 * upright}`);
  assert.deepEqual(faults, []);
});

test('the model grows on the page while the platform turns', async (t) => {
  // The scan lasts longer than a busy machine takes to show a second mesh.
  const scanner = await startScanner(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await chooseQuickScan(page, 200);
  const sizes = new Set();  // bytes of the preview meshes so far
  const hasGrown = new Promise((done) => {
    page.on('response', (response) => {
      if (response.url().endsWith('/preview.stl') && response.status() === 200) {
        sizes.add(response.headers()['content-length']);
        if (sizes.size === 2) {
          done(sizes);
        }
      }
    });
  });
  await page.getByRole('button', {name: 'Start scan'}).click();
  await hasGrown;
  await page.locator('#cancel').click();
  await page.getByText('Scan ended', {exact: true}).waitFor();
  assert.deepEqual(faults, []);
});
