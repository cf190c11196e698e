// The colours of a scan by laser line: in model files, read by other programs, and in the viewer.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';
import {validateBytes} from 'gltf-validator';

import {complaints} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {scan, startScanner} from './scanner.js';

const run = promisify(execFile);

/** Writes each vertex that Open3D reads as six doubles: position in millimetres, colour from 0 to 1. */
const verticesByOpen3d = `
import sys, numpy, open3d
mesh = open3d.io.read_triangle_mesh(sys.argv[1])
numpy.hstack([numpy.asarray(mesh.vertices), numpy.asarray(mesh.vertex_colors)]).tofile(sys.argv[2])
`;

/** @returns {Promise<Float64Array>} */
async function readByOpen3d(file) {
  await run('/usr/bin/python3', ['-c', verticesByOpen3d, file, `${file}.vertices`]);
  return new Float64Array(new Uint8Array(await readFile(`${file}.vertices`)).buffer);
}

const sectors = 8;
const saturation = 0.4;  // of the simulated object's colours

/**
 * The chrominance of vertices by sector around the axis. The simulated object's paint has a constant saturation, and its hue goes
 * once round the axis: (blue - luminance) / luminance and (red - luminance) / luminance trace a circle.
 * @param {Float64Array} vertices
 * @returns {{painted: number[], seen: number[], count: number}[]}
 */
function bySector(vertices) {
  const all = Array.from({length: sectors}, () => ({painted: [0, 0], sum: [0, 0, 0], count: 0}));
  for (let i = 0; i < vertices.length; i += 6) {
    const [x, y, z, ...colour] = vertices.subarray(i, i + 6);
    const radius = Math.hypot(x, y);
    if (radius > 5 && z > 5) {  // near the axis a pixel mixes hues, and the camera does not see the underside
      const sector = all[Math.floor((Math.atan2(y, x) / (2 * Math.PI) + 1) * sectors) % sectors];
      sector.painted = sector.painted.map((value, k) => value + saturation * [x, y][k] / radius);
      sector.sum = sector.sum.map((value, k) => value + colour[k]);
      ++sector.count;
    }
  }
  return all.map(({painted, sum: [red, green, blue], count}) => {
    const light = 0.299 * red + 0.587 * green + 0.114 * blue;
    return {count, painted: painted.map((value) => value / count), seen: [(blue / light - 1) / 1.772, (red / light - 1) / 1.402]};
  });
}

/** The colourfulness of a screenshot: the mean difference of its channels, 0 to 255. */
const colourfulness = async (page, png) => page.evaluate(async (base64) => {
  const image = new Image();
  image.src = `data:image/png;base64,${base64}`;
  await image.decode();
  const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
  context.drawImage(image, 0, 0);
  const {data} = context.getImageData(0, 0, image.width, image.height);
  let sum = 0;
  for (let i = 0; i < data.length; i += 4) {
    sum += Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]);
  }
  return sum / (data.length / 4);
}, png.toString('base64'));

/** The viewer shows the model's colours, and hides them. */
async function lookAtColours(t, {url}, id) {
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, `${url}#${id}`);
  await page.locator('#tools').waitFor();
  const clay = await page.locator('#view').screenshot();
  const names = await page.locator('#formats a').allInnerTexts();
  assert.deepEqual(names, ['3MF', 'PLY', 'GLB', 'OBJ', '3MF in colour', 'PLY in colour', 'GLB in colour', 'OBJ in colour', 'Raw scan']);
  const button = page.getByRole('button', {name: 'Show colours'});
  const answer = page.waitForResponse(/Scan\.ply\?colour=true/);
  await button.click();
  assert.equal((await answer).status(), 200);
  await page.locator('#measured').waitFor({state: 'hidden'});
  const painted = await page.locator('#view').screenshot();
  await picture(page, 'colours');
  const [before, after] = [await colourfulness(page, clay), await colourfulness(page, painted)];
  assert.ok(after > before + 3, `${before} and ${after}`);
  assert.deepEqual(await complaints(page), []);
  await button.click();
  const again = await colourfulness(page, await page.locator('#view').screenshot());
  assert.ok(Math.abs(again - before) < 0.5, `${before} and ${again}`);
  // The page asks every rig for its sensor's points; a rig with a camera has none and answers 404.
  assert.deepEqual(faults.filter((fault) => !fault.includes('404')), []);
}

test('a scan by laser line has the colours of what was scanned, in files and in the viewer', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate-laser', '--simulate-speed', '30']});
  const {id, state, has_colours, has_views, error} = await scan(scanner, {snapshots: 24, leaf_size_mm: 1});
  assert.deepEqual([state, has_colours, has_views], ['finished', true, false], JSON.stringify(error));
  const get = (name) => fetch(`${scanner.url}api/v1/scans/${id}/${name}`);
  const fetched = async (name) => Buffer.from(await (await get(name)).arrayBuffer());
  const triangles = (await fetched('Scan.stl')).readUInt32LE(80);

  const [plyBytes, glb, threemf] = await Promise.all(['Scan.ply', 'Scan.glb', 'Scan.3mf'].map((name) => fetched(`${name}?colour=true`)));
  const ply = join(scanner.data, 'model.ply');
  await writeFile(ply, plyBytes);
  const vertices = await readByOpen3d(ply);
  // Pictures of a dark room have four levels; rounding changes a hue whose dimmest channel has one level.
  for (const [number, {painted, seen, count}] of bySector(vertices).entries()) {
    const told = `sector ${number}: ${painted.map((v) => v.toFixed(3))} painted, ${seen.map((v) => v.toFixed(3))} seen, ${count} vertices`;
    t.diagnostic(told);
    assert.ok(count > 100 && painted.every((value, i) => Math.abs(value - seen[i]) < 0.08), told);
  }

  const {issues, info} = await validateBytes(new Uint8Array(glb));
  assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], JSON.stringify(issues.messages));
  assert.deepEqual([info.totalTriangleCount, info.totalVertexCount], [triangles, vertices.length / 6]);
  await writeFile(join(scanner.data, 'model.3mf'), threemf);
  assert.match((await run('prusa-slicer', ['--info', join(scanner.data, 'model.3mf')])).stdout, new RegExp(`number_of_facets = *${triangles}`));
  assert.ok(!(await fetched('Scan.ply')).includes('property uchar red'), 'without being asked for there are none');

  const refused = await get('Scan.stl?colour=true');
  assert.deepEqual([refused.status, (await refused.json()).code], [400, 'bad-settings']);
  assert.equal((await get('Scan.ply?colour=yes')).status, 400);
  assert.equal((await get('builds/0/Scan.stl?colour=true')).status, 400);
  assert.ok((await fetched('builds/0/Scan.ply?colour=true')).equals(plyBytes));
  await lookAtColours(t, scanner, id);
});

test('a scan without pictures has no colours, and says so', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '30']});
  const {id, has_colours, has_views} = await scan(scanner, {snapshots: 8, filter: 'basic', leaf_size_mm: 4});
  assert.deepEqual([has_colours, has_views], [false, true]);
  const refused = await fetch(`${scanner.url}api/v1/scans/${id}/Scan.glb?colour=true`);
  const {code, detail, hint} = await refused.json();
  assert.deepEqual([refused.status, code, detail], [400, 'bad-settings', 'this scan has no pictures in colour']);
  assert.match(hint, /laser line/);
});
