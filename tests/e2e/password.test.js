import assert from 'node:assert/strict';
import {test} from 'node:test';
import {setTimeout as sleep} from 'node:timers/promises';

import {emptyPage, openBrowser, picture} from './browser.js';
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

const wrongProof = 'Digest username="octurn", realm="Octurn", nonce="0", uri="/", qop=auth, nc=00000001, cnonce="0", response="0"';

/** Guesses wrong passwords at the visitors' address. */
function startGuessing(t, url, pause) {
  const answers = new Map();
  let isWanted = true;
  const end = (async () => {
    while (isWanted) {
      const {status} = await fetch(url, {headers: {'Authorization': wrongProof}});
      answers.set(status, (answers.get(status) ?? 0) + 1);
      await sleep(answers.get(429) ? pause : 0);
    }
  })();
  end.catch(() => {}); // a test that has failed stops the scanner
  t.after(() => {
    isWanted = false;
  });
  return {
    awaitLocked: async () => {
      while (!answers.has(429)) {
        await sleep(50);
      }
    },
    stop: async () => {
      isWanted = false;
      await end;
      return Object.fromEntries(answers);
    },
  };
}

/**
 * Whoever has logged in stays in while somebody guesses at the same address. Whoever is new there waits until chance
 * lets one of its tries in: beside a guess in two seconds, half a minute on average.
 */
async function getsInWhileAnotherGuesses(t, browser, scanner, page, password) {
  const guesser = startGuessing(t, scanner.url, 2000);
  await guesser.awaitLocked();
  assert.equal((await page.reload()).status(), 200);
  await page.getByLabel('New password').waitFor();
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'});

  const begin = Date.now();
  const visitor = await visit(browser, scanner.url, password);
  if (visitor.status === 429) { // else it was lucky at once
    assert.match(await visitor.page.textContent('p[lang=en]'), /^Please wait: somebody is guessing the password/);
    await picture(visitor.page, 'guessed');
  }
  await visitor.page.getByRole('button', {name: 'Start scan'}).waitFor();
  await visitor.page.locator('[data-panel=waiting]').waitFor({state: 'hidden'});
  t.diagnostic(`let in after ${(Date.now() - begin) / 1000} s beside ${JSON.stringify(await guesser.stop())}`);
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
  await getsInWhileAnotherGuesses(t, browser, scanner, page, password);

  await page.getByRole('button', {name: 'Remove the password'}).click();
  await page.getByText('Everybody in this network may use the scanner.').waitFor();
  assert.equal((await fetch(scanner.url)).status, 200);
});
