// A model against the STL that stood on the simulated platform, and two models of a scan against each other.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {complaints, overflow} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {ask, scan, startScanner} from './scanner.js';

const run = promisify(execFile);

/** A lump without symmetry, some 80 mm high, on the platform. @returns {number[][][]} triangles */
function lump() {
  const bands = 60;
  const corner = (band, sector) => {
    const isPole = band === 0 || band === bands;
    const [polar, angle] = [Math.PI * band / bands, isPole ? 0 : Math.PI * (sector % (2 * bands)) / bands];
    const flat = isPole ? 0 : Math.sin(polar);
    const radius = 30 * (1 + flat * (0.2 * Math.cos(3 * angle + 0.5) + 0.25 * Math.cos(angle) * Math.cos(polar) + 0.15 * Math.sin(angle)));
    return [radius * flat * Math.cos(angle), 0.7 * radius * flat * Math.sin(angle), 1.4 * radius * Math.cos(polar) + 42];
  };
  const triangles = [];
  for (let band = 0; band < bands; ++band) {
    for (let sector = 0; sector < 2 * bands; ++sector) {
      const [a, b, c, d] = [corner(band, sector), corner(band + 1, sector), corner(band + 1, sector + 1), corner(band, sector + 1)];
      band > 0 && triangles.push([a, b, d]);
      band + 1 < bands && triangles.push([b, c, d]);
    }
  }
  return triangles;
}

/** @param {number[][][]} triangles */
function stlOf(triangles) {
  const file = Buffer.alloc(84 + 50 * triangles.length);
  file.writeUInt32LE(triangles.length, 80);
  triangles.flat(2).forEach((value, i) => file.writeFloatLE(value, 84 + 50 * Math.floor(i / 9) + 12 + 4 * (i % 9)));
  return file;
}

/** Lays a model on the truth near which it is, by Open3D's own registration, and prints the mean distance of what was seen. */
const measuredByOpen3d = `
import sys, numpy, open3d
def read(path):
    raw = numpy.fromfile(path, dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")], offset=84)
    return raw["v"].astype(float), raw["a"]
model, attributes = read(sys.argv[1])
truth, _ = read(sys.argv[2])
seen = model[attributes != 1]
areas = numpy.linalg.norm(numpy.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0]), axis=1)
draw = numpy.random.default_rng(1)
def sample(triangles, weights, count):
    chosen = triangles[draw.choice(len(triangles), count, p=weights / weights.sum())]
    r, s = numpy.sqrt(draw.random(count)), draw.random(count)
    return (1 - r)[:, None] * chosen[:, 0] + (r * (1 - s))[:, None] * chosen[:, 1] + (r * s)[:, None] * chosen[:, 2]
cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(sample(seen, areas, 60000)))
mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(truth.reshape(-1, 3)), open3d.utility.Vector3iVector(numpy.arange(3 * len(truth)).reshape(-1, 3)))
target = mesh.sample_points_uniformly(400000)
target.estimate_normals(open3d.geometry.KDTreeSearchParamHybrid(2, 30))
fit = open3d.pipelines.registration.registration_icp(cloud, target, 4, numpy.eye(4), open3d.pipelines.registration.TransformationEstimationPointToPlane())
cloud.transform(fit.transformation)
scene = open3d.t.geometry.RaycastingScene()
scene.add_triangles(open3d.core.Tensor(truth.reshape(-1, 3).astype(numpy.float32)), open3d.core.Tensor(numpy.arange(3 * len(truth)).reshape(-1, 3).astype(numpy.uint32)))
print(float(scene.compute_distance(open3d.core.Tensor(numpy.asarray(cloud.points).astype(numpy.float32))).numpy().mean()))
`;

/** @returns {Promise<number>} a figure of the result, millimetres or percent */
async function figure(page, label) {
  const words = await page.locator('#compare-facts > div', {hasText: label}).locator('dd').innerText();
  return Number(words.replace('\u2212', '-').replace('+', '').replace(/[^\d.-]/g, ''));
}

async function waitForResult(page) {
  await page.waitForFunction(() => !document.getElementById('compare-result').hidden || document.getElementById('compare-said').dataset.tone === 'bad');
  assert.ok(await page.locator('#compare-result').isVisible(), await page.locator('#compare-said').innerText());
}

test('a model is compared with its STL, wherever that lies, as Open3D measures it; and with another model', async (t) => {
  const triangles = lump();
  const folder = await mkdtemp(join(tmpdir(), 'octurn-lump-'));
  t.after(() => rm(folder, {recursive: true, force: true}));
  const truth = join(folder, 'lump.stl');
  await writeFile(truth, stlOf(triangles));
  const scanner = await startScanner(t, {rig: [`--simulate=${truth}`, '--simulate-speed', '30', '--simulate-perfect']});
  const {id} = await scan(scanner, {snapshots: 24, leaf_size_mm: 1, filter: 'basic', name: 'Lump'});
  const {page, faults} = await openPage(await openBrowser(t), `${scanner.url}#${id}`);
  await page.locator('#tools').waitFor();

  const [yaw, tilt] = [0.9, 0.35];
  const turned = triangles.map((corners) => corners.map(([x, y, z]) => {
    const [u, v] = [x * Math.cos(yaw) - y * Math.sin(yaw), x * Math.sin(yaw) + y * Math.cos(yaw)];
    return [u + 40, v * Math.cos(tilt) - z * Math.sin(tilt) - 12, v * Math.sin(tilt) + z * Math.cos(tilt) + 5];
  }));
  await page.getByText('Compare with a reference').click();
  await page.getByRole('button', {name: 'Compare', exact: true}).click();
  await page.getByText('Choose an STL file first.').waitFor();
  await page.getByLabel('STL in millimetres').setInputFiles({name: 'lump.stl', mimeType: 'model/stl', buffer: stlOf(turned)});
  await page.getByRole('button', {name: 'Compare', exact: true}).click();
  await waitForResult(page);
  const model = join(scanner.data, 'model.stl');
  await writeFile(model, Buffer.from(await (await fetch(`${scanner.url}api/v1/scans/${id}/Scan.stl`)).arrayBuffer()));
  const {stdout} = await run('/usr/bin/python3', ['-c', measuredByOpen3d, model, truth]);
  const [shown, measured] = [await figure(page, 'Mean distance'), Number(stdout)];
  t.diagnostic(`mean distance: ${shown} mm, by Open3D ${measured} mm`);
  assert.ok(measured > 0.02 && Math.abs(shown - measured) < 0.03, `${shown} mm, by Open3D ${measured} mm`);
  await page.getByLabel('Tolerance', {exact: true}).fill('0.2');
  assert.ok(await page.locator('#compare-histogram rect').count() === 41);
  assert.deepEqual(await complaints(page), []);
  await page.locator('#compare-result').scrollIntoViewIfNeeded();
  await picture(page, 'compare-desktop');
  await page.setViewportSize({width: 390, height: 844});
  assert.ok(await overflow(page) <= 0);
  await page.locator('#compare-result').scrollIntoViewIfNeeded();
  await picture(page, 'compare-phone');
  await page.setViewportSize({width: 1280, height: 860});

  await page.evaluate(() => {
    globalThis.print = () => {
      globalThis.printed = document.getElementById('compare-printed').cloneNode(true);
    };
  });
  await page.getByRole('button', {name: 'Print a report'}).click();
  await page.waitForFunction(() => globalThis.printed);
  await page.evaluate(() => document.body.append(globalThis.printed));
  await page.emulateMedia({media: 'print'});
  const report = page.locator('#compare-printed');
  assert.match(await report.innerText(), /Lump[^]*Compared with lump\.stl[^]*Within 0\.20\smm[^]*Mean distance/);
  const sides = await report.locator('img').evaluate((image) => [image.naturalWidth, image.naturalHeight]);
  assert.ok(Math.min(...sides) > 100, `its picture has ${sides} pixels`);
  assert.ok(await page.locator('main').first().isHidden(), 'nothing else is printed');
  await picture(page, 'compare-report');
  await page.emulateMedia({media: null});
  await report.evaluate((element) => element.remove());

  const begun = await ask(scanner, `scans/${id}/builds`, 'POST', {leaf_size_mm: 4});
  for (let {state} = begun; state !== 'finished';) {
    await new Promise((done) => {
      setTimeout(done, 300);
    });
    ({state} = await ask(scanner, `scans/${id}/builds/${begun.build}`));
    assert.notEqual(state, 'failed');
  }
  await page.locator('#build-rows li').nth(1).waitFor();
  await page.locator('#compare-build option').nth(1).waitFor({state: 'attached'});
  await page.getByLabel('Or another model of this scan').selectOption({index: 1});
  await page.getByRole('button', {name: 'Compare', exact: true}).click();
  await page.locator('#compare-with', {hasText: 'lump.stl'}).waitFor({state: 'hidden'});
  await waitForResult(page);
  const between = await figure(page, 'Mean distance');
  assert.ok(between > 0.005 && between < 2, `${between} mm between leaves of 1 and 4 mm`);
  assert.deepEqual(faults, []);
});
