// Thirty objects in a row: one tap each after the first; then tags, a table and the models of all in one file.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {complaints, overflow} from './access.js';
import {goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, scan, startScanner} from './scanner.js';

const run = promisify(execFile);
const fast = {rig: ['--simulate', '--simulate-speed', '60']};
const objects = 30;

/** Prints a table and an archive as JSON, as Python's own modules read them. */
const readByPython = `
import csv, json, sys, zipfile
with open(sys.argv[1], encoding="utf-8-sig", newline="") as table:
    rows = list(csv.DictReader(table))
with zipfile.ZipFile(sys.argv[2]) as archive:
    broken = archive.testzip()
    files = {info.filename: info.file_size for info in archive.infolist()}
    inside = list(csv.DictReader(archive.read("scans.csv").decode("utf-8-sig").splitlines()))
print(json.dumps({"rows": rows, "broken": broken, "files": files, "inside": inside}))
`;

/** The settings that a person chooses; the others are what the scanner has learnt. */
const chosen = ({platform_from_sensor: _, depth_scale: __, ...settings}) => settings;

/** Writes into the label's fields below a scan. @param {Record<string, string>} texts  by label */
async function writeLabel(page, texts) {
  const more = page.locator('details.label');
  await more.locator('summary').click();
  for (const [label, text] of Object.entries(texts)) {
    await more.getByLabel(label, {exact: true}).fill(text);
    const saved = page.waitForResponse((response) => response.request().method() === 'PATCH');
    await page.keyboard.press('Tab');
    assert.equal((await saved).status(), 200, label);
  }
}

/** @returns {Promise<string>} the path of what a click on a link downloads */
async function downloaded(page, link, folder) {
  const [arrived] = await Promise.all([page.waitForEvent('download'), link.click()]);
  const path = join(folder, arrived.suggestedFilename());
  await arrived.saveAs(path);
  return path;
}

test('thirty objects are scanned with one tap each, tagged, listed and downloaded', async (t) => {
  const scanner = await startScanner(t, fast);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url, {screen: 'phone'});
  const first = await scan(scanner, {snapshots: 4, leaf_size_mm: 8, filter: 'basic', name: 'Möwe 09'});
  await page.goto(`${scanner.url}#${first.id}`);
  await writeLabel(page, {'Tags': 'Grave 3, ceramics', 'Author': 'Jane Doe', 'Licence': 'CC BY 4.0', 'Inventory number': '2026.17.3'});
  await picture(page, 'label-phone');
  for (let number = 10; number < 9 + objects; ++number) {
    await page.getByRole('button', {name: `Next object Möwe ${number}`}).click();
    await page.getByRole('heading', {name: `Möwe ${number}`}).waitFor();
  }
  const {scans} = await ask(scanner, 'scans');
  assert.equal(scans.length, objects);
  for (const [index, {name, state, settings, tags, author, licence, inventory_number: number}] of scans.entries()) {
    assert.deepEqual([name, state], [index === objects - 1 ? 'Möwe 09' : `Möwe ${8 + objects - index}`, 'finished']);
    assert.deepEqual(chosen(settings), chosen(first.settings), name);
    assert.deepEqual([tags, author, licence], [['Grave 3', 'ceramics'], 'Jane Doe', 'CC BY 4.0'], name);
    assert.equal(number, index === objects - 1 ? '2026.17.3' : '', `${name}: no object has another's number`);
  }
  await picture(page, 'next-object-phone');

  const other = await scan(scanner, {snapshots: 4, leaf_size_mm: 8, filter: 'basic', name: 'Owl'});
  await goTo(page, 'Library');
  await page.locator(`#rows [data-key="${other.id}"]`).waitFor();
  await page.locator(`#rows [data-key="${first.id}"]`).getByRole('button', {name: 'ceramics'}).click();
  await page.waitForFunction((count) => document.querySelectorAll('#rows > li').length === count, objects);
  await page.getByRole('button', {name: 'Select', exact: true}).click();
  await page.getByRole('button', {name: 'Select all'}).click();
  await page.getByLabel('Tag', {exact: true}).fill('to print');
  await page.getByRole('button', {name: 'Add tag'}).click();
  await page.locator(`#rows [data-key="${first.id}"]`).getByRole('button', {name: 'to print'}).waitFor();
  assert.deepEqual(await complaints(page), []);
  assert.ok(await overflow(page) <= 0);
  await picture(page, 'chosen-phone');
  await page.setViewportSize({width: 1280, height: 860});
  await picture(page, 'chosen-desktop');

  await page.getByLabel('Format of the models').selectOption('3mf');
  const models = await downloaded(page, page.getByRole('link', {name: `ZIP of ${objects}`}), scanner.data);
  const table = await downloaded(page, page.getByRole('link', {name: 'Table (CSV)'}), scanner.data);
  const {stdout} = await run('/usr/bin/python3', ['-c', readByPython, table, models], {maxBuffer: 1e7});
  const {rows, broken, files, inside} = JSON.parse(stdout);
  assert.equal(broken, null);
  assert.equal(rows.length, objects);
  assert.deepEqual(inside.map(({name, file}) => [name, file]), rows.map(({name}) => [name, `${name}.3mf`]));
  const expected = [...scans].reverse();
  for (const [index, row] of rows.entries()) {
    const {id, name, model} = expected[index];
    assert.deepEqual([row.id, row.name, row.tags, row.author, row.licence, row.triangles, row.watertight],
        [id, name, 'Grave 3, ceramics, to print', 'Jane Doe', 'CC BY 4.0', String(model.triangles), String(model.watertight)]);
    assert.ok(Math.abs(row.volume_cm3 - model.volume_cm3) < 1e-9 && Math.abs(row.z_mm - model.size_mm[2]) < 1e-9, name);
    const alone = await fetch(`${scanner.url}api/v1/scans/${id}/Scan.3mf`);
    assert.equal(files[`${name}.3mf`], (await alone.arrayBuffer()).byteLength, name);
  }
  assert.deepEqual(Object.keys(files).length, objects + 1);
  assert.deepEqual(faults, []);
});

/** Prints what the files of a model say of it, as Python's own modules read them. */
const metadataByPython = `
import json, sys, zipfile
import xml.etree.ElementTree as xml
core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
with zipfile.ZipFile(sys.argv[1]) as archive:
    model = xml.fromstring(archive.read("3D/3dmodel.model"))
with open(sys.argv[2], "rb") as glb:
    head = glb.read(20)
    asset = json.loads(glb.read(int.from_bytes(head[12:16], "little")))["asset"]
with open(sys.argv[3], "rb") as ply:
    comments = []
    for line in iter(ply.readline, b"end_header\\n"):
        if line.startswith(b"comment "):
            comments.append(line[8:-1].decode())
print(json.dumps({"threemf": {item.get("name"): item.text for item in model.findall(core + "metadata")}, "asset": asset, "comments": comments}))
`;

test('another program finds the number, the author and the licence in 3MF, GLB and PLY', async (t) => {
  const scanner = await startScanner(t, fast);
  const {id} = await scan(scanner, {snapshots: 4, leaf_size_mm: 8, filter: 'basic', name: 'Möwe <1>'});
  const read = async () => {
    const paths = await Promise.all(['3mf', 'glb', 'ply'].map(async (ending) => {
      const path = join(scanner.data, `model.${ending}`);
      const response = await fetch(`${scanner.url}api/v1/scans/${id}/Scan.${ending}`);
      await writeFile(path, Buffer.from(await response.arrayBuffer()));
      return path;
    }));
    const {stdout} = await run('/usr/bin/python3', ['-c', metadataByPython, ...paths]);
    return JSON.parse(stdout);
  };
  const before = await read();
  assert.deepEqual(before.threemf, {Title: 'Möwe <1>', Application: 'Octurn'});
  assert.deepEqual(before.asset, {version: '2.0', generator: 'Octurn'});
  await ask(scanner, `scans/${id}`, 'PATCH', {inventory_number: 'B & C 17', author: 'Jörg "Doe"', licence: 'CC BY 4.0'});
  const {threemf, asset, comments} = await read();
  assert.deepEqual(threemf, {'Title': 'Möwe <1>', 'Designer': 'Jörg "Doe"', 'LicenseTerms': 'CC BY 4.0',
    'octurn:InventoryNumber': 'B & C 17', 'Application': 'Octurn'});
  assert.deepEqual([asset.copyright, asset.extras],
      ['Jörg "Doe", CC BY 4.0', {inventory_number: 'B & C 17', author: 'Jörg "Doe"', licence: 'CC BY 4.0'}]);
  assert.deepEqual(comments, ['millimetres, Z up', 'name Möwe <1>', 'inventory number B & C 17', 'author Jörg "Doe"', 'licence CC BY 4.0']);
});

test('a refused ZIP says on the page why', async (t) => {
  const scanner = await startScanner(t, fast);
  for (let count = 0; count < 2; ++count) {
    const {id} = await ask(scanner, 'scans', 'POST', {snapshots: 200, frames: 20});
    await ask(scanner, `scans/${id}/cancel`, 'POST');
    while ((await ask(scanner, `scans/${id}`)).state === 'running');
  }
  const {page} = await openPage(await openBrowser(t, {hasWebGl: false}), `${scanner.url}#library`, {screen: 'phone'});
  await page.getByRole('button', {name: 'Select', exact: true}).click();
  await page.getByRole('button', {name: 'Select all'}).click();
  await page.getByRole('link', {name: 'ZIP of 2'}).click();
  await page.getByText('No ZIP was made').waitFor();
  await page.getByText('None of these scans has a model.').waitFor();
  await picture(page, 'zip-refused-phone');
});
