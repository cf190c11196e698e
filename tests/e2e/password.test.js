import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';

import {openBrowser} from './browser.js';
import {startScanner} from './scanner.js';

/** A configuration whose page has this password. */
async function configWith(t, password) {
  const folder = await mkdtemp(join(tmpdir(), 'octurn-password-'));
  t.after(() => rm(folder, {recursive: true}));
  const file = join(folder, 'password');
  const command = spawn(process.env.OCTURN_PROGRAM, ['password', file], {stdio: ['pipe', 'ignore', 'inherit']});
  command.stdin.end(`${password}\n`);
  assert.deepEqual(await once(command, 'exit'), [0, null]);
  await writeFile(join(folder, 'octurn.json'), JSON.stringify({password_file: file}));
  return join(folder, 'octurn.json');
}

/** How a browser that knows this password is answered, and what it shows then. */
async function visit(browser, url, password) {
  const context = await browser.newContext({httpCredentials: {username: 'octurn', password}});
  const page = await context.newPage();
  const answer = await page.goto(url);
  return {page, status: answer.status()};
}

test('the page opens with its password alone', async (t) => {
  const config = await configWith(t, 'open sesame: ä "quoted"');
  const scanner = await startScanner(t, {rig: ['--simulate', '--simulate-speed', '8', '--config', config]});
  const browser = await openBrowser(t);

  const stranger = await visit(browser, scanner.url, 'open');
  assert.equal(stranger.status, 401);
  assert.doesNotMatch(await stranger.page.content(), /Start scan/);

  const {page, status} = await visit(browser, scanner.url, 'open sesame: ä "quoted"');
  assert.equal(status, 200);
  await page.getByRole('button', {name: 'Start scan'}).waitFor();
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'}); // its own requests are let in, too
});
