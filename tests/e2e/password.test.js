import assert from 'node:assert/strict';
import {test} from 'node:test';

import {emptyPage, openBrowser} from './browser.js';
import {configWith} from './password.js';
import {startScanner} from './scanner.js';

/** Opens the page in a browser with this password. */
async function visit(browser, url, password) {
  const page = await emptyPage(browser, {password});
  const response = await page.goto(url);
  return {page, status: response?.status()};
}

test('the page opens with its password alone', async (t) => {
  const password = 'open sesame: ä "quoted"';
  const config = await configWith(t, password);
  const scanner = await startScanner(t, {rig: ['--simulate', '--config', config]});
  const browser = await openBrowser(t);

  assert.equal((await fetch(scanner.url)).status, 401);
  const refused = await visit(browser, scanner.url, 'open');
  assert.equal(refused.status, 401);
  assert.ok(await refused.page.getByRole('button', {name: 'Start scan'}).isHidden());

  const {page} = await visit(browser, scanner.url, password);
  await page.getByRole('button', {name: 'Start scan'}).waitFor();
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'}); // the page's own requests are accepted, too
});

/** Whoever has logged in stays in while somebody guesses at the same address; whoever is new there does not get in. */
async function staysWhileAnotherGuesses(browser, scanner, page, password) {
  const guess = () => fetch(scanner.url, {headers: {'Authorization':
    'Digest username="octurn", realm="Octurn", nonce="0", uri="/", qop=auth, nc=00000001, cnonce="0", response="0"'}});
  const guessUntilLocked = async () => {
    let status = 401;
    for (let guesses = 0; status === 401 && guesses < 100; ++guesses) {
      ({status} = await guess());
    }
    assert.equal(status, 429);
  };
  await guessUntilLocked();
  assert.equal((await page.reload()).status(), 200);
  await page.getByLabel('New password').waitFor();
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'});
  await guessUntilLocked(); // a guess is free again after ten seconds
  assert.equal((await visit(browser, scanner.url, password)).status, 429);
}

test('a password that is typed into the page is in force at once, and is not sent', async (t) => {
  const password = 'open sesame: ä "quoted"';
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  const page = await emptyPage(browser, {password}); // what the visitor answers when the browser asks
  const bodies = [];
  page.on('request', (request) => bodies.push(request.postData() ?? ''));
  await page.goto(`${scanner.url}#settings`);

  await page.getByLabel('New password').fill('seven77');
  await page.getByRole('button', {name: 'Set password'}).click();
  await page.getByText('Use 8 to 100 characters.').waitFor();
  assert.equal((await fetch(scanner.url)).status, 200);

  await page.getByLabel('New password').fill(password);
  await page.getByRole('button', {name: 'Set password'}).click();
  await page.getByText('The page asks for a password.').waitFor();
  assert.equal(await page.getByLabel('New password').inputValue(), '');
  assert.equal((await fetch(scanner.url)).status, 401);
  assert.ok(bodies.some((body) => /^\{"hash":"[0-9a-f]{32}"\}$/.test(body)), bodies.join('\n'));
  assert.ok(!bodies.some((body) => body.includes('sesame')));
  assert.equal((await visit(browser, scanner.url, 'open')).status, 401);
  assert.equal((await visit(browser, scanner.url, password)).status, 200);

  await page.reload();
  await staysWhileAnotherGuesses(browser, scanner, page, password);

  await page.getByRole('button', {name: 'Remove the password'}).click();
  await page.getByText('Everybody in this network may use the scanner.').waitFor();
  assert.equal((await fetch(scanner.url)).status, 200);
});
