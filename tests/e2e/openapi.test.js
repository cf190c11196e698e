// The HTTP interface matches its OpenAPI description, and the page shows that description.

import {Validator} from '@seriousme/openapi-schema-validator';
import Ajv from 'ajv/dist/2020.js';
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {openBrowser, openPage, picture} from './browser.js';
import {ask, quick, scan, startScanner} from './scanner.js';

/** Validates the scanner's responses against its OpenAPI description. */
class Answers {
  #ajv = new Ajv({strict: false, validateFormats: false});
  #description;

  constructor(description) {
    this.#description = description;
    this.#ajv.addSchema(description, 'octurn');
  }

  /** @param {string} status @param {any} body  of the response to `method` of `path` */
  check(path, method, status, body) {
    const key = path.replaceAll('~', '~0').replaceAll('/', '~1');
    assert.ok(this.#description.paths[path]?.[method]?.responses[status], `${method} ${path} ${status}`);
    const validate = this.#ajv.compile({$ref: `octurn#/paths/${key.replaceAll('{', '%7B').replaceAll('}', '%7D')}/${method}/responses/${status}/content/application~1json/schema`});
    assert.ok(validate(body), `${method} ${path}: ${this.#ajv.errorsText(validate.errors)} in ${JSON.stringify(body)}`);
  }
}

test('it is OpenAPI 3.1, and what the scanner answers is as it says', async (t) => {
  const scanner = await startScanner(t, quick);
  const description = await ask(scanner, 'openapi.json');
  const validated = await new Validator().validate(description);
  assert.ok(validated.valid, JSON.stringify(validated.errors));

  const answers = new Answers(description);
  const v1 = '/api/v1/';
  answers.check(`${v1}status`, 'get', '200', await ask(scanner, 'status'));
  const job = await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  answers.check(`${v1}scans/{id}`, 'get', '200', job);
  for (const path of ['status', 'scans', 'settings', 'settings/backup', 'calibration', 'turntable', 'doctor', 'bin', 'keys', 'preview/points']) {
    answers.check(v1 + path, 'get', '200', await ask(scanner, path));
  }
  for (const part of ['builds', 'poses']) {
    answers.check(`${v1}scans/{id}/${part}`, 'get', '200', await ask(scanner, `scans/${job.id}/${part}`));
  }
  answers.check(`${v1}scans/{id}/builds/{number}`, 'get', '200', await ask(scanner, `scans/${job.id}/builds/0`));
  answers.check(`${v1}scans/estimate`, 'post', '200', await ask(scanner, 'scans/estimate', 'POST', {snapshots: 36}));
  assert.throws(() => answers.check(`${v1}scans/{id}`, 'get', '200', {...job, state: 'asleep'}));

  const problem = await (await fetch(`${scanner.url}api/v1/scans/none`)).json();
  const isProblem = new Ajv({strict: false, validateFormats: false}).compile({...description.components.schemas.Problem, components: description.components});
  assert.ok(isProblem(problem), JSON.stringify(problem));
  const refused = await fetch(`${scanner.url}api/v1/scans`, {method: 'POST', headers: {'Content-Type': 'application/json'}, body: '{"snapshots": 0}'});
  const {code: why, parameters} = await refused.json();
  assert.deepEqual([why, parameters.key, parameters.minimum], ['bad-settings', 'snapshots', 1]);
  for (const [method, path] of [['GET', 'api/none'], ['GET', 'api/v1/none'], ['POST', 'api/v1/none']]) {
    const lost = await fetch(scanner.url + path, {method, headers: {'Content-Type': 'application/json'}});
    const {code, hint} = await lost.json();
    assert.deepEqual([lost.status, code], [404, 'not-found'], path);
    assert.match(hint, /\/api\/v1\//, `${path}: a program is told where to look, and not of the page`);
  }
});

test('what the disk has room for is counted in scans as they were, not as they could be', async (t) => {
  const scanner = await startScanner(t, quick);
  await scan(scanner, {snapshots: 4, leaf_size_mm: 4});
  const {findings} = await ask(scanner, 'doctor');
  const room = findings.find(({check}) => check === 'disk').measured;
  const {disk_free_bytes: free} = await ask(scanner, 'status');
  const {bytes, measured} = await ask(scanner, 'scans/estimate', 'POST', {});
  assert.ok(measured);
  const scans = Number(/enough for (\d+) scans/.exec(room)[1]);
  assert.ok(Math.abs(scans * bytes / free - 1) < 0.2, `${room}: ${bytes} bytes each`);
});

test('a page shows it', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  for (const screen of ['desktop', 'phone']) {
    const {page, faults} = await openPage(browser, scanner.url, {screen});
    await page.getByRole('link', {name: 'For programs'}).click();
    const start = page.locator('.operation', {hasText: 'Start a scan'});
    await start.locator('summary').click();
    await start.getByText('ScanSettings').waitFor();
    assert.deepEqual(await complaints(page), []);
    assert.ok(await overflow(page) <= 0);
    await picture(page, `interface-${screen}`);
    assert.deepEqual(faults, []);
    await page.context().close();
  }
});
