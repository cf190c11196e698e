import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';
import {fileURLToPath} from 'node:url';

import {complaints, overflow} from './access.js';
import {chooseQuickScan, goTo, openBrowser, openPage, picture} from './browser.js';
import {measure} from '../web/mesh_file.js';
import {ask, startScanner} from './scanner.js';

/** Clicks at several points around a place in a picture until `hasHelped`. */
async function clickUntil(page, {x, y, width, height}, part, hasHelped) {
  for (let i = 0; i < 40 && !await hasHelped(); ++i) {
    await page.mouse.click(x + (part - 0.08 + 0.04 * (i % 5)) * width, y + (0.25 + 0.06 * Math.floor(i / 5)) * height);
  }
  assert.ok(await hasHelped());
}

/**
 * Clicks that pick three pairs in the fit dialog. The second cloud is clicked after a drag of the picture, as a point that faces the
 * camera on one cloud may be hidden on the other. Runs in the page.
 * @param {{scan: string, object_from_platform: number[][]}} fit  the right pose
 * @returns {Promise<{drag: number, pairs: number[][][]} | undefined>}  canvas pixels of each pair: on the first cloud, and after the drag on the
 *     further side's cloud
 */
async function clicksOfPairs({scan, object_from_platform}) {
  const [{Matrix4, Vector3}, {besides, cloudOf, lookAt, makeEye, pointAt}] = await Promise.all([import('/three.js'), import('/model/fit_clouds.js')]);
  const canvas = document.getElementById('fit-view');
  const {clientWidth: width, clientHeight: height} = canvas;
  const {before_mm, pose_mm} = await (await fetch(`/api/v1/scans/${scan}/poses/1/points`)).json();
  const clouds = [cloudOf(before_mm, 0), cloudOf(pose_mm, 0)];
  clouds[1].matrix.copy(besides(clouds));
  clouds[1].updateMatrixWorld(true);
  const eyeAfter = (drag) => {
    const eye = makeEye();
    eye.aspect = width / height;
    const {middle} = lookAt(eye, clouds, true);
    eye.position.sub(middle).applyAxisAngle(eye.up, -2 * Math.PI * drag / height).add(middle);
    eye.lookAt(middle);
    eye.updateMatrixWorld(true);
    return eye;
  };
  /** The pixel of a cloud's point, if picking there finds a point near it. */
  const clickOf = (eye, number, point) => {
    const at = point.clone().applyMatrix4(clouds[number].matrixWorld).project(eye);
    const [x, y] = [(at.x + 1) / 2 * width, (1 - at.y) / 2 * height];
    const found = x > 0 && x < width && y > 0 && y < height ? pointAt(clouds, eye, canvas, x, y) : null;
    return found?.cloud === number && point.distanceTo(new Vector3(...found.point_mm)) < 3 ? [x, y] : null;
  };
  const before_from_side = new Matrix4().set(...object_from_platform.slice(0, 3).flatMap(([x, y, z, shift]) => [x, y, z, 1000 * shift]), 0, 0, 0, 1);
  const places = pose_mm.filter((_, i) => i % 11 === 0).map((point) => {
    const side = new Vector3(...point);
    const before = side.clone().applyMatrix4(before_from_side);
    return {side, before, click: clickOf(eyeAfter(0), 0, before)};
  }).filter(({click}) => click);
  for (const eighths of [4, 3, -3, 2, -2, 1, -1, 0]) {
    const drag = eighths / 8 * height;
    const eye = eyeAfter(drag);
    const pairs = [];
    for (const {side, before, click} of places) {
      const isApart = pairs.every((pair) => pair.before.distanceTo(before) > 25) && (pairs.length !== 2 ||
          pairs[1].before.clone().sub(pairs[0].before).cross(before.clone().sub(pairs[0].before)).length() > 800);
      const other = isApart && clickOf(eye, 1, side);
      if (other) {
        pairs.push({before, clicks: [click, other]});
      }
      if (pairs.length === 3) {
        return {drag, pairs: pairs.map(({clicks}) => clicks)};
      }
    }
  }
}

/** Clicks a point until `shown` appears; clicks before the points are drawn are lost. */
async function clickAt(page, x, y, shown) {
  for (let clicks = 1; await shown.count() === 0; ++clicks) {
    await page.mouse.click(x, y);
    await shown.waitFor({timeout: 5000 * clicks}).catch((error) => {
      if (clicks === 8) {
        throw error;
      }
    });
  }
}

/** The rotation between two poses (4 x 4 matrices), degrees. */
function degreesBetween(one, other) {
  const trace = [0, 1, 2].reduce((sum, row) => sum + [0, 1, 2].reduce((part, column) => part + one[row][column] * other[row][column], 0), 0);
  return Math.acos(Math.min((trace - 1) / 2, 1)) * 180 / Math.PI;
}

test('an object is scanned, turned over, scanned again, and downloaded as one model; the other side is removed, and restored', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '20']});
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await chooseQuickScan(page, 8);
  await page.getByRole('button', {name: 'Start scan'}).click();
  const add = page.getByRole('button', {name: 'Turn it over and scan the underside'});
  await add.waitFor();
  await add.click();
  await page.getByText('Side 2 is in the model').waitFor();
  assert.match(await page.locator('#side-rows').innerText(), /shares \d+% of its surface[^]*fits to \d\.\d\d\smm/);

  const {scans: [pose, first]} = await ask(scanner, 'scans');
  assert.deepEqual([pose.pose_of.scan, first.poses.length, first.build], [first.id, 1, 1]);
  await goTo(page, 'Library');
  await page.locator('#rows > li').first().waitFor();
  assert.equal(await page.locator('#rows > li').count(), 1, 'both are one entry of the list');
  await page.goBack();
  const download = page.getByRole('link', {name: 'Download STL'}).first();
  const [arrived] = await Promise.all([page.waitForEvent('download'), download.click()]);
  const mesh = measure(await readFile(await arrived.path()));
  assert.equal(mesh.openEdges, 0);
  assert.equal(mesh.triangles, first.model.triangles);
  await page.locator('#tools').waitFor();
  await picture(page, 'both-sides');
  assert.deepEqual(await complaints(page), []);
  assert.ok(await overflow(page) <= 0, `${await overflow(page)} pixels too wide`);

  await page.getByRole('button', {name: 'See the fit: side 2'}).click();
  const text = page.locator('#fit-text');
  await text.filter({hasText: /^Fit 1 of \d, as in the model: \d+% of this side/}).waitFor();
  await picture(page, 'fit');
  assert.deepEqual(await complaints(page), []);
  await page.getByRole('button', {name: 'Show another fit'}).click();
  await text.filter({hasText: /^Fit 2 of \d, another way/}).waitFor();
  await page.getByRole('button', {name: 'Set three pairs'}).click();
  await text.filter({hasText: /^Pair 1 of 3/}).waitFor();
  await picture(page, 'fit-pairs');
  const canvas = await page.locator('#fit-view').boundingBox();
  await clickUntil(page, canvas, 0.28, () => text.filter({hasText: /the same point of side 2/}).count());
  await clickUntil(page, canvas, 0.72, () => text.filter({hasText: /^Pair 2 of 3/}).count());
  await picture(page, 'fit-pair');
  await page.getByRole('button', {name: 'Undo'}).click();
  await text.filter({hasText: /the same point of side 2/}).waitFor();
  await page.getByRole('button', {name: 'Undo'}).click();
  await page.getByRole('button', {name: 'Back to the fits'}).click();
  await page.getByRole('button', {name: 'Use this fit'}).click();
  // With this object, an arm on the wrong side contradicts about as much as is allowed: either outcome is right.
  await page.getByText('The model was not built').or(page.getByText('Build 2, of 2 sides')).first().waitFor();

  const {object_from_platform} = pose.pose_of.registration;
  await page.getByRole('button', {name: 'See the fit: side 2'}).click();
  await page.getByRole('button', {name: 'Set three pairs'}).click();
  await text.filter({hasText: /^Pair 1 of 3/}).waitFor();
  // The page is served in bundles, so its single modules come from the source tree.
  await page.route(/\/(three|model\/fit_clouds)\.js$/, (route) => route.fulfill({
    path: fileURLToPath(new URL(`../../web${new URL(route.request().url()).pathname}`, import.meta.url)), contentType: 'text/javascript'}));
  const {drag, pairs} = await page.evaluate(clicksOfPairs, {scan: first.id, object_from_platform});
  const {x: left, y: top, width, height} = await page.locator('#fit-view').boundingBox();
  const turn = async (by) => {
    await page.mouse.move(left + width / 2 - by / 2, top + height - 10);
    await page.mouse.down();
    await page.mouse.move(left + width / 2 + by / 2, top + height - 10, {steps: 4});
    await page.mouse.up();
  };
  for (const [index, [before, side]] of pairs.entries()) {
    await clickAt(page, left + before[0], top + before[1], text.filter({hasText: /the same point of side 2/}));
    await turn(drag);
    const next = index < 2 ? `Pair ${index + 2} of 3` : 'Three pairs are set.';
    await clickAt(page, left + side[0], top + side[1], text.filter({hasText: next}));
    await turn(-drag);
  }
  await text.filter({hasText: 'Three pairs are set.'}).waitFor();
  await picture(page, 'fit-three-pairs');
  await page.getByRole('button', {name: 'Fit by these pairs'}).click();
  await page.waitForFunction(async (scan) => {
    const {poses: [{registration}]} = await (await fetch(`/api/v1/scans/${scan}/poses`)).json();
    return registration.candidate === null;
  }, first.id, {polling: 300});
  const {poses: [{registration}]} = await ask(scanner, `scans/${first.id}/poses`);
  assert.ok(degreesBetween(registration.object_from_platform, object_from_platform) < 1, 'the pairs tell the pose that was found');
  assert.equal((await ask(scanner, `scans/${first.id}`)).model.watertight, true);

  await page.getByRole('button', {name: 'Scan one more side'}).click();
  await page.getByText('Side 3 is in the model').waitFor();
  const {poses, model} = await ask(scanner, `scans/${first.id}`);
  assert.deepEqual([poses.length, model.watertight], [2, true]);
  await picture(page, 'three-sides');
  await page.getByRole('button', {name: 'Remove this side: 3'}).click();
  await page.getByText('Side 3 is in the model').waitFor({state: 'detached'});

  const remove = page.getByRole('button', {name: 'Remove this side: 2'});
  const {model: merged} = await ask(scanner, `scans/${first.id}`);
  await remove.click();
  await add.waitFor();
  assert.deepEqual((await ask(scanner, 'bin')).scans.map(({id}) => id).sort(), poses.map(({scan}) => scan).sort(), 'no scan is lost');
  await picture(page, 'side-removed');
  const undo = page.getByRole('status').filter({hasText: 'In the bin: Side 2.'}).getByRole('button', {name: 'Undo'});
  await undo.click();
  await page.getByText('Side 2 is in the model').waitFor();
  assert.equal((await ask(scanner, `scans/${first.id}`)).model.triangles, merged.triangles, 'the model is what it was');
  await remove.click();
  await add.waitFor();
  const {scans} = await ask(scanner, 'scans');
  assert.deepEqual([scans.length, scans[0].build, scans[0].poses], [1, 0, []]);
  assert.deepEqual(faults, []);
});
