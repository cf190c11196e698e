// Access keys for other programs, created on the page.

import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {emptyPage, openBrowser, openPage, picture} from './browser.js';
import {configWith} from './password.js';
import {startScanner} from './scanner.js';

const password = 'open sesame';

/** Creates a key on the page. @returns {Promise<string>} */
async function makeKey(page, name, access) {
  const card = page.locator('#keys-card');
  await card.getByLabel('Name').fill(name);
  await card.getByLabel('Access').selectOption(access);
  await card.getByRole('button', {name: 'Make a key'}).click();
  await card.getByText(name, {exact: true}).waitFor();
  return card.getByLabel('The new key').inputValue();
}

test('a key lets a program in until it is revoked', async (t) => {
  const scanner = await startScanner(t, {rig: ['--simulate', '--config', await configWith(t, password)]});
  const status = async (key, path, method = 'GET') => (await fetch(`${scanner.url}${path}`,
      {method, headers: {'Authorization': `Bearer ${key}`, 'Content-Type': 'application/json'}, body: method === 'GET' ? undefined : '{}'})).status;
  const page = await emptyPage(await openBrowser(t), {password});
  await page.goto(`${scanner.url}#settings`);

  await page.getByRole('button', {name: 'Make a key'}).click();
  await page.getByText('Enter what the key is for.').waitFor();
  const reader = await makeKey(page, 'Home Assistant', 'read');
  const writer = await makeKey(page, 'A script', 'full');

  assert.equal(await status(reader, 'api/v1/status'), 200);
  assert.equal(await status(reader, ''), 200);
  assert.equal(await status(reader, 'api/v1/scans/estimate', 'POST'), 403);
  assert.equal(await status(writer, 'api/v1/scans/estimate', 'POST'), 200);
  assert.equal(await status(writer, 'api/v1/keys'), 403);
  assert.equal(await status(writer, 'api/v1/settings/password', 'PUT'), 403);
  assert.equal(await status('octurn-0-0', 'api/v1/status'), 401);
  assert.ok(!(await readFile(join(scanner.data, 'keys.json'), 'utf8')).includes(reader.split('-')[2]));

  await page.reload();
  assert.equal(await page.getByLabel('The new key').isVisible(), false);
  await page.getByRole('button', {name: 'Revoke the key Home Assistant'}).click();
  await page.getByText('Home Assistant', {exact: true}).waitFor({state: 'detached'});
  assert.equal(await status(reader, 'api/v1/status'), 401);
  await scanner.end();
  await scanner.restart();
  assert.equal(await status(reader, 'api/v1/status'), 401);
  assert.equal(await status(writer, 'api/v1/status'), 200);
});

test('the keys are for everyone', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  for (const [screen, colorScheme] of [['phone', 'dark'], ['desktop', 'light']]) {
    const {page, faults} = await openPage(browser, scanner.url, {screen, colorScheme});
    await page.goto(`${scanner.url}#settings`);
    await makeKey(page, `Home Assistant on the ${screen}`, 'read');
    assert.deepEqual(await complaints(page), []);
    assert.ok(await overflow(page) <= 0);
    await picture(page, `keys-${screen}`);
    assert.deepEqual(faults, []);
    await page.context().close();
  }
});
