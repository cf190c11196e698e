// A client that a generator makes of the OpenAPI description works, and its types are right.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {test} from 'node:test';
import {promisify} from 'node:util';

import openapiTS, {astToString} from 'openapi-typescript';

import {scanByClient} from './client.js';
import {ask, quick, startScanner} from './scanner.js';

const run = promisify(execFile);
const here = new URL('.', import.meta.url);

/** What TypeScript complains of in a file. @param {string} file @returns {Promise<string>} */
async function complaintsOf(file) {
  const options = '--noEmit --allowJs --checkJs --strict --skipLibCheck --target es2022 --module nodenext'.split(' ');
  const {stdout} = await run('node_modules/.bin/tsc', [...options, file], {cwd: here}).catch((error) => error);
  return stdout;
}

test('a generated client does what its types say', async (t) => {
  const scanner = await startScanner(t, quick);
  const description = await ask(scanner, 'openapi.json');
  await writeFile(new URL('octurn.d.ts', here), astToString(await openapiTS(description)));
  assert.equal(await complaintsOf('client.js'), '');
  await writeFile(new URL('wrong_client.js', here), `import createClient from 'openapi-fetch';
/** @type {import('openapi-fetch').Client<import('./octurn.js').paths>} */
const client = createClient({});
await client.POST('/api/v1/scans', {body: {snapshots: 'eight'}});
`);
  assert.match(await complaintsOf('wrong_client.js'), /string.*number/);

  const {id, verdict, bytes, refused} = await scanByClient(scanner.url.replace(/\/$/, ''));
  const scan = await ask(scanner, `scans/${id}`);
  assert.equal(scan.name, 'by a client');
  assert.equal(scan.model.bytes, bytes);
  assert.ok(['good', 'look', 'bad'].includes(String(verdict)));
  assert.equal(refused, 'bad-settings');
});
