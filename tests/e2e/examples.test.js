// The examples of docs/programs.md, run as written.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {mkdtemp, open, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {ask, quick, startScanner} from './scanner.js';

/** @param {string} language @returns {Promise<string[]>} the examples in it */
async function examplesIn(language) {
  const text = await readFile(join(process.env.OCTURN_DOCS ?? '', 'programs.md'), 'utf8');
  return [...text.matchAll(new RegExp(`^\`\`\`${language}\\n(.*?)^\`\`\``, 'gms'))].map(([, example]) => example);
}

/** @returns {Promise<string>} the first bytes of a file, as text */
async function beginOf(folder, name) {
  const file = await open(join(folder, name));
  const {buffer} = await file.read(Buffer.alloc(8), 0, 8, 0);
  await file.close();
  return buffer.toString('latin1');
}

/** Replaces the other hosts of the examples; nothing listens at this port. */
const nobody = 'http://127.0.0.1:9';

for (const withKey of [true, false]) {
  test(`those with curl do what they say, ${withKey ? 'with a key' : 'without one'}`, (t) => runExamples(t, withKey));
}

/** @param {import('node:test').TestContext} t @param {boolean} withKey */
async function runExamples(t, withKey) {
  const scanner = await startScanner(t, quick);
  const folder = await mkdtemp(join(tmpdir(), 'octurn-examples-'));
  t.after(() => rm(folder, {recursive: true}));
  const key = withKey ? (await ask(scanner, 'keys', 'POST', {name: 'curl', access: 'full'})).key : '';
  const examples = await examplesIn('sh');
  assert.ok(examples.length >= 7);
  const script = examples.join('echo; echo ----\n').replaceAll(/http:\/\/\w+\.local:\d+/g, nobody);
  const {stdout} = await promisify(execFile)('sh', ['-euc', script],
      {cwd: folder, env: {...process.env, OCTURN: scanner.url.replace(/\/$/, ''), KEY: key}, maxBuffer: 1 << 24});

  const said = stdout.split('\n----\n').map((text) => text.trim());
  assert.equal(said.length, examples.length);
  assert.equal(JSON.parse(said[0]).scan, null);
  assert.match(said.at(-4), /^data: \{"scans_revision":\d+\}$/);
  assert.equal(JSON.parse(said.at(-3)).code, 'no-such-scan');
  assert.equal(JSON.parse(said.at(-2)).webhooks[0].address, nobody);
  assert.deepEqual([await ask(scanner, 'webhooks'), await ask(scanner, 'printers')].map(({webhooks, printers}) => webhooks ?? printers), [[], []]);
  const {scans} = await ask(scanner, 'scans');
  assert.deepEqual(scans.map(({name}) => name), ['Owl', 'Owl']);  // one scanned here, one imported
  assert.equal((await ask(scanner, `scans/${scans[1].id}/builds`)).builds.length, 2);
  const begins = {'Scan.3mf': 'PK', 'Scan.glb': 'glTF', 'Scan.ply': 'ply', 'thumbnail.png': '\x89PNG', 'scan.zip': 'PK'};
  for (const [name, begin] of Object.entries(begins)) {
    assert.ok((await beginOf(folder, name)).startsWith(begin), name);
  }
}

test('that for Home Assistant names addresses and values that there are', async (t) => {
  const scanner = await startScanner(t);
  const [example] = await examplesIn('yaml');
  const {id} = await ask(scanner, 'scans', 'POST', {snapshots: 200, leaf_size_mm: 4});
  const resources = example.split('- resource: http://octurn.local/').slice(1);
  assert.equal(resources.length, 2);
  for (const resource of resources) {
    const answer = await (await fetch(scanner.url + resource.split('\n')[0])).json();
    const values = [...resource.matchAll(/value_json((?:\.\w+|\[0\])+)/g)].map(([, path]) => path.replace('[0]', '.0').slice(1).split('.'));
    assert.ok(values.length >= 2);
    for (const path of values) {
      assert.notEqual(path.reduce((value, key) => value?.[key], answer), undefined, path.join('.'));
    }
  }
  await ask(scanner, `scans/${id}/cancel`, 'POST');
});
