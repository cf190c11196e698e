// What is cut, laid, erased and scaled on the page is what is downloaded, and slicers take it without any repair.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {complaints, overflow} from './access.js';
import {clickModel, openBrowser, openPage, picture} from './browser.js';
import {ask, quick, scan, scanFolders, startScanner} from './scanner.js';

const run = promisify(execFile);

/** Downloads a model, and fails if admesh or prusa-slicer finds anything to repair. @returns its volume and sizes, by admesh */
async function measured(scanner, url, name) {
  const file = join(scanner.data, name);
  await writeFile(file, Buffer.from(await (await fetch(new URL(url, scanner.url))).arrayBuffer()));
  const said = (await run('admesh', [file])).stdout;
  for (const what of ['Degenerate facets', 'Edges fixed', 'Facets removed', 'Facets added', 'Facets reversed', 'Backwards edges', 'Normals fixed']) {
    assert.match(said, new RegExp(`${what}\\s*:\\s*0\\b`), what);
  }
  assert.match(said, /Total disconnected facets\s*:\s*0\s+0/);
  assert.match((await run('prusa-slicer', ['--info', file])).stdout, /manifold = yes/);
  const number = (pattern) => Number(pattern.exec(said)[1]);
  const range = (axis) => ['Min', 'Max'].map((end) => number(new RegExp(`${end} ${axis}\\s*[=:]\\s*(-?[\\d.]+)`)));
  return {volume: number(/Volume\s*:\s*(-?[\d.]+)/), x: range('X'), y: range('Y'), z: range('Z')};
}

const height = ({z}) => z[1] - z[0];

/** @returns {Promise<number[]>} width, depth and area of the flat top of a downloaded model */
async function topOf(scanner, name) {
  const file = await readFile(join(scanner.data, name));
  const facets = Array.from({length: file.readUInt32LE(80)}, (_, facet) => Array.from({length: 3}, (__, corner) =>
    Array.from({length: 3}, (___, axis) => file.readFloatLE(84 + 50 * facet + 12 + 12 * corner + 4 * axis))));
  const highest = Math.max(...facets.flat().map(([, , z]) => z));
  const flat = facets.filter((corners) => corners.every(([, , z]) => z > highest - 0.1));
  const area = flat.reduce((sum, [a, b, c]) => sum + ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2, 0);
  const reach = (axis) => Math.max(...flat.flat().map((at) => at[axis])) - Math.min(...flat.flat().map((at) => at[axis]));
  return [reach(0), reach(1), area];
}

/** Measures the model by clicks on it and by a key, and takes the tool off again. */
async function measureIt(page, {x, y, z}) {
  await page.getByRole('button', {name: 'Measure the model'}).click();
  const said = page.locator('#measured');
  await page.getByRole('button', {name: 'Size', exact: true}).click();
  await said.filter({hasText: 'Width'}).waitFor();
  const sides = [x, y, z].map(([min, max]) => (max - min).toFixed(1));
  assert.equal(await said.innerText(), `Width × depth × height: ${sides.join(' × ')}\u00a0mm`);
  assert.deepEqual(await page.locator('#labels span').allInnerTexts(), sides.map((side) => `${side}\u00a0mm`));
  await picture(page, 'edits-size');
  const kinds = [
    ['Distance', [0.3, 0.4], /^[\d.]+\smm \(ΔX/], ['Diameter', [0.3, 0.35, 0.4], /^⌀ [\d.]+\smm$/], ['Angle', [0.3, 0.4], /^[\d.]+°$/]];
  for (const [kind, shares, pattern] of kinds) {
    await page.getByRole('button', {name: kind, exact: true}).click();
    for (const share of shares) {
      await clickModel(page, share);
    }
    if (kind === 'Angle') {
      await page.locator('#view').focus();
      await page.keyboard.press('Enter');  // on the chest, which is in the middle
    }
    await said.filter({hasText: pattern}).waitFor();
    assert.equal(await page.locator('#labels span').count(), 1);
    await picture(page, `edits-${kind.toLowerCase()}`);
  }
  assert.deepEqual(await complaints(page), []);
  await page.getByRole('button', {name: 'Measure the model'}).click();
  await page.locator('#measure-kinds').waitFor({state: 'hidden'});
  assert.equal(await page.locator('#labels span').count(), 0);
}

/** Waits until a build is the scan's model and in view. */
async function awaitBuild(page, scanner, id, build) {
  await page.locator(`#build-rows > li:nth-child(${build + 1}) .build-chosen`).waitFor();
  await page.locator('#tools').waitFor();
  const now = await ask(scanner, `scans/${id}`);
  assert.equal(now.build, build);
  return now;
}

/**
 * Clicks on the front of the figure's body, from where the model is first seen. In the middle of the picture are its legs or the
 * gap between them, below its centre: from there it would stand as it stands.
 */
async function clickBody(page) {
  if (await page.locator('#turn[aria-pressed=true]').count() > 0) {
    await page.locator('#turn').click();
  }
  await page.locator('#reset-view').click();
  await clickModel(page, 0.35);
}

test('a model is cut, laid, erased, cropped and scaled on the page, and can be taken back', async (t) => {
  const scanner = await startScanner(t, quick);
  const made = await scan(scanner, {snapshots: 12, leaf_size_mm: 1, filter: 'basic'});
  const [folder] = await scanFolders(scanner);
  const snapshot = await readFile(join(folder, 'snapshots/003.png'));
  const first = await readFile(join(folder, 'Scan.stl'));
  const whole = await measured(scanner, made.model.url, 'whole.stl');
  const {page, faults} = await openPage(await openBrowser(t), `${scanner.url}#${made.id}`);
  await page.locator('#tools').waitFor();
  const make = page.getByRole('button', {name: 'Make this the model'});
  assert.ok(await make.isHidden(), 'nothing was done to it');
  await measureIt(page, whole);

  await page.getByRole('button', {name: 'Cut the model open'}).click();
  const sections = {};
  for (const name of ['X', 'Y', 'Z']) {
    await page.getByRole('button', {name, exact: true}).click();
    await page.locator('#cut-share').fill('0.4');
    await page.locator('#measured').filter({hasText: 'Section'}).waitFor();
    const at = 0.6 * whole[name.toLowerCase()][0] + 0.4 * whole[name.toLowerCase()][1];
    assert.ok(Math.abs(parseFloat(await page.locator('#cut-at').innerText()) - at) < 0.11, name);
    sections[name] = (await page.locator('#measured').innerText()).match(/[\d.]+/g).map(Number);
    await picture(page, `edits-cut-${name}`);
  }
  assert.equal(new Set(Object.values(sections).map(([, , area]) => area)).size, 3, JSON.stringify(sections));
  assert.deepEqual(await complaints(page), []);
  await make.click();
  const cut = await awaitBuild(page, scanner, made.id, 1);
  const half = await measured(scanner, cut.model.url, 'cut.stl');
  assert.ok(Math.abs(half.z[1] - 0.4 * height(whole)) < 0.05 && half.z[0] === 0, `cut at ${half.z[1]} of ${height(whole)} mm`);
  const top = await topOf(scanner, 'cut.stl');
  t.diagnostic(`section: ${sections.Z.join(', ')}; of the model that was built: ${top.join(', ')}`);
  const rim = 1;  // millimetres: the upper edge of the built model is a voxel wide
  const around = 2 * (top[0] + top[1]);
  assert.ok(sections.Z.every((value, i) => Math.abs(value - top[i]) < (i < 2 ? 2 * rim : rim * around)), `${sections.Z} and not ${top}`);
  assert.equal(cut.model.quality, null);
  assert.match(await page.locator('#build-rows > li:nth-child(2)').innerText(), /edited/);

  await page.getByRole('button', {name: 'Lay it on another side'}).click();
  await clickBody(page);
  await make.waitFor();
  await picture(page, 'edits-laid');
  await make.click();
  const laid = await awaitBuild(page, scanner, made.id, 2);
  const lying = await measured(scanner, laid.model.url, 'laid.stl');
  assert.ok(Math.abs(lying.volume - half.volume) < 1e-3 * half.volume, `${lying.volume} of ${half.volume} mm3`);
  assert.ok(Math.abs(lying.z[0]) < 0.01 && Math.abs(height(lying) - height(half)) > 1, `from ${lying.z[0]} to ${lying.z[1]} mm`);
  assert.ok([lying.x, lying.y].every(([min, max]) => Math.abs(min + max) < 0.1 * (max - min)), 'in the middle');

  await page.getByRole('button', {name: 'Erase a part'}).click();
  await page.locator('#erase-radius').fill('8');
  await clickBody(page);
  await picture(page, 'edits-erased');
  await make.click();
  const erased = await awaitBuild(page, scanner, made.id, 3);
  const holed = await measured(scanner, erased.model.url, 'erased.stl');
  const {settings} = (await ask(scanner, `scans/${made.id}/builds`)).builds[3];
  assert.deepEqual([settings.cut_mm.length, settings.erase_mm.length, settings.lay_mm.length], [1, 1, 6]);
  const ball = 4 / 3 * Math.PI * 8 ** 3;
  assert.ok(lying.volume - holed.volume > 0.1 * ball && lying.volume - holed.volume < 1.01 * ball, `${lying.volume - holed.volume} mm3`);

  await page.getByText('Build again', {exact: true}).click();
  await page.getByLabel('Scale').fill('0.5');
  await page.getByLabel('Most triangles').fill('3000');
  await page.locator('#build-crop').getByLabel('Right, to').fill('5');
  await picture(page, 'edits-form');
  assert.deepEqual(await complaints(page), []);
  assert.ok(await overflow(page) <= 0);
  await page.getByRole('button', {name: 'Build', exact: true}).click();
  const row = page.locator('#build-rows > li:nth-child(5)');
  await row.waitFor();
  const small = (await ask(scanner, `scans/${made.id}/builds`)).builds[4];
  assert.ok(small.model.triangles <= 3000, `${small.model.triangles} triangles`);
  const last = await measured(scanner, small.model.url, 'small.stl');
  assert.ok(last.volume < 0.125 * holed.volume && last.volume > 0.02 * holed.volume);

  await page.getByLabel('Most triangles').fill('100');
  await page.getByRole('button', {name: 'Build', exact: true}).click();
  await page.getByText(/This model cannot have fewer than [\d,]+ triangles\. Allow more/).waitFor();
  await picture(page, 'edits-too-few');

  await page.locator('#build-rows > li:nth-child(1)').getByRole('button', {name: 'Use this model'}).click();
  await page.locator('#build-rows > li:nth-child(1) .build-chosen').waitFor();
  const back = await ask(scanner, `scans/${made.id}`);
  assert.deepEqual([back.build, back.model.quality], [0, made.model.quality]);
  assert.ok(first.equals(Buffer.from(await (await fetch(`${scanner.url}api/v1/scans/${made.id}/Scan.stl`)).arrayBuffer())));
  assert.ok(snapshot.equals(await readFile(join(folder, 'snapshots/003.png'))), 'the snapshots are as they were');
  assert.deepEqual(faults, []);
});

test('a model by intersection is laid and scaled, and says that it is not cut', async (t) => {
  const scanner = await startScanner(t, quick);
  const made = await scan(scanner, {snapshots: 6, leaf_size_mm: 4, filter: 'basic', method: 'intersection'});
  await assert.rejects(ask(scanner, `scans/${made.id}/builds`, 'POST', {cut_mm: [[0, 0, 1, 30]]}), /400 .*cut_mm.*intersection/);
  await ask(scanner, `scans/${made.id}/builds`, 'POST', {lay_mm: [0, 0, 1, 0, 0, 100], scale: 2, choose: true});
  let build;
  do {
    [, build] = (await ask(scanner, `scans/${made.id}/builds`)).builds;
  } while (build.state !== 'finished');
  const turned = await measured(scanner, build.model.url, 'turned.stl');
  const whole = await measured(scanner, `api/v1/scans/${made.id}/builds/0/Scan.stl`, 'as-scanned.stl');
  assert.ok(Math.abs(turned.z[0] - 2 * (100 - whole.z[1])) < 0.01 && Math.abs(turned.volume - 8 * whole.volume) < 0.001 * turned.volume);
});
