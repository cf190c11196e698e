// The scanner's event stream, for the page and for other programs.

import assert from 'node:assert/strict';
import {once} from 'node:events';
import {createServer, request as forward} from 'node:http';
import {test} from 'node:test';

import {emptyPage, openBrowser, openPage} from './browser.js';
import {ask, quick, startScanner} from './scanner.js';

const maxWatchers = 8;

/**
 * Reads the event stream until `wanted` holds.
 * @param {string} [lastEventId]
 * @returns {Promise<{kind: string, id: string, data: any}[]>} all events
 */
async function watch(scanner, wanted, lastEventId) {
  const abort = new AbortController();
  const response = await fetch(`${scanner.url}api/v1/events`,
      {signal: abort.signal, headers: lastEventId ? {'Last-Event-ID': lastEventId} : {}});
  assert.equal(response.status, 200);
  assert.equal(response.headers.get('Content-Type'), 'text/event-stream');
  assert.equal(response.headers.get('X-Accel-Buffering'), 'no');
  const events = [];
  let text = '';
  for await (const part of response.body.pipeThrough(new TextDecoderStream())) {
    const blocks = (text + part).split('\n\n');
    text = blocks.pop();
    for (const block of blocks.filter((one) => one.includes('data:'))) {
      const fields = Object.fromEntries(block.split('\n').map((line) => [line.slice(0, line.indexOf(':')), line.slice(line.indexOf(':') + 2)]));
      events.push({kind: fields.event, id: fields.id ?? '', data: JSON.parse(fields.data)});
    }
    if (events.some(wanted)) {
      break;
    }
  }
  abort.abort();
  return events;
}

test('programs are told what is, what changes, and nothing twice', async (t) => {
  const scanner = await startScanner(t);
  const first = await watch(scanner, ({kind}) => kind === 'status');
  assert.deepEqual(first.map(({kind}) => kind), ['devices', 'warnings', 'scans', 'status']);
  assert.equal(first[3].data.scan, null);
  assert.deepEqual(first[0].data.sensor, first[3].data.sensor);

  const told = watch(scanner, ({kind, data}) => kind === 'status' && data.scan, first[3].id);
  const {id} = await ask(scanner, 'scans', 'POST', {snapshots: 200, leaf_size_mm: 4});
  const news = await told;
  assert.equal(news.at(-1).data.scan.id, id);
  assert.ok(news.some(({kind, data}) => kind === 'scans' && data.scans_revision !== first[2].data.scans_revision));
  await ask(scanner, `scans/${id}/cancel`, 'POST');
});

test('the page shows what it is told without asking, and asks where it is not told', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  const {page} = await openPage(browser, scanner.url);
  const isTold = page.evaluate(() => new Promise((done) => {
    const news = new EventSource('/api/v1/events');
    news.addEventListener('status', () => {
      news.close();
      done(true);
    });
  }));
  assert.ok(await isTold);
  await page.route('**/api/v1/status', (route) => route.abort());
  const {id} = await ask(scanner, 'scans', 'POST', {snapshots: 200, leaf_size_mm: 4});
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await ask(scanner, `scans/${id}/cancel`, 'POST');
  await page.getByText('Scan ended', {exact: true}).waitFor();
  await page.context().close();

  const deaf = await emptyPage(browser);
  await deaf.route('**/api/v1/events', (route) => route.abort());
  await deaf.goto(scanner.url);
  const {id: second} = await ask(scanner, 'scans', 'POST', {snapshots: 200, leaf_size_mm: 4});
  await deaf.getByRole('progressbar', {name: 'Scan'}).waitFor();
  await ask(scanner, `scans/${second}/cancel`, 'POST');
});

test('more watchers than there may be are told to ask, and the page opens for them', async (t) => {
  const scanner = await startScanner(t);
  const abort = new AbortController();
  t.after(() => abort.abort());
  for (let i = 0; i < maxWatchers; ++i) {
    assert.equal((await fetch(`${scanner.url}api/v1/events`, {signal: abort.signal})).status, 200);
  }
  const refused = await fetch(`${scanner.url}api/v1/events`);
  assert.equal(refused.status, 503);
  assert.equal(refused.headers.get('Retry-After'), '30');
  assert.equal((await refused.json()).code, 'too-many');

  const {page} = await openPage(await openBrowser(t), scanner.url);
  await page.getByRole('button', {name: 'Start scan'}).click();
  await page.getByRole('progressbar', {name: 'Scan'}).waitFor();
});

/** Serves a scanner in the folder /scanner/ of another address, as docs/security.md has it. @returns {Promise<string>} the page's address */
async function behindProxy(t, scanner) {
  const proxy = createServer((asked, answer) => {
    if (!asked.url.startsWith('/scanner/')) {
      answer.writeHead(404).end();
      return;
    }
    const {hostname, port} = new URL(scanner.url);
    const to = forward({hostname, port, method: asked.method, path: asked.url.slice('/scanner'.length), headers: asked.headers});
    to.on('response', (from) => {
      answer.writeHead(from.statusCode, from.headers);
      from.pipe(answer);
    });
    to.on('error', () => answer.destroy());
    answer.on('close', () => to.destroy());
    asked.pipe(to);
  });
  t.after(() => {
    proxy.closeAllConnections();
    proxy.close();
  });
  await once(proxy.listen(0, '127.0.0.1'), 'listening');
  return `http://127.0.0.1:${proxy.address().port}/scanner/`;
}

test('behind a proxy that serves it in a folder the page scans, shows the model and gives it away', async (t) => {
  const scanner = await startScanner(t, quick);
  const url = await behindProxy(t, scanner);
  const {page, faults} = await openPage(await openBrowser(t), url);
  const heard = page.waitForRequest('**/scanner/api/v1/events');
  await page.reload();
  await heard;
  const {id} = await ask(scanner, 'scans', 'POST', {snapshots: 4, frames: 2, leaf_size_mm: 4});
  const drawn = page.waitForResponse('**/scanner/api/v1/scans/**/*.stl');
  await page.goto(`${url}#${id}`);
  assert.equal((await drawn).status(), 200);
  const download = page.getByRole('link', {name: 'Download STL'}).first();
  const [arrived] = await Promise.all([page.waitForEvent('download'), download.click()]);
  assert.equal(arrived.suggestedFilename(), 'Scan.stl');
  await page.getByRole('button', {name: 'Rename this scan'}).click();
  await page.getByLabel('Name', {exact: true}).fill('Behind a proxy');
  await page.keyboard.press('Enter');
  await page.getByText('Behind a proxy').first().waitFor();
  assert.equal((await ask(scanner, `scans/${id}`)).name, 'Behind a proxy');
  assert.deepEqual(faults, []);
});
