// Bytes and round trips of a first visit, counted in a browser with the real program.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {emptyPage, openBrowser} from './browser.js';
import {quick, scan, startScanner} from './scanner.js';

const maxForm = 80e3;  // bytes, without the live picture, which never ends
const maxSight = 400e3;  // bytes until a model is first seen in 3D, with an empty cache
const maxRounds = 4;

/**
 * Records a page's transfers as sent over the network, headers and bodies.
 * @returns {Promise<{all: {url: string, bytes: number, after: string | null}[]}>}  after: the URL that started the request
 */
async function count(page) {
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  const open = new Map();
  const all = [];
  session.on('Network.requestWillBeSent', ({requestId, request: {url}, initiator, documentURL}) => {
    const frames = [];
    for (let stack = initiator.stack; stack; stack = stack.parent) {
      frames.push(...stack.callFrames.map((frame) => frame.url));
    }
    open.set(requestId, {url, bytes: 0, after: url === documentURL ? null : frames.find(Boolean) ?? initiator.url ?? documentURL});
  });
  session.on('Network.loadingFinished', ({requestId, encodedDataLength}) => {
    const request = open.get(requestId);
    if (request) {
      all.push({...request, bytes: encodedDataLength});
    }
  });
  return {all};
}

/** The round trips until a request is answered: one more than those of the URL that started it. */
function rounds(all, {after}) {
  const first = all.find(({url}) => url === after);
  return after === null || !first ? 1 : 1 + rounds(all, first);
}

const sum = (all) => all.reduce((bytes, request) => bytes + request.bytes, 0);
const table = (all) => all.map((request) => `${rounds(all, request)} ${request.bytes} ${request.url}`).join('\n');

test('the form comes in at most 80 kB and four round trips, the first sight of a model in at most 400 kB, and what is kept only once', async (t) => {
  const scanner = await startScanner(t, quick);
  const browser = await openBrowser(t);
  const page = await emptyPage(browser);
  const {all} = await count(page);
  await page.goto(scanner.url);
  await page.locator('#start').waitFor();
  await page.waitForFunction(() => performance.getEntriesByType('resource').some(({name, responseEnd}) => name.endsWith('/api/v1/settings') && responseEnd > 0));
  const form = all.filter(({url}) => !url.includes('/preview/'));
  t.diagnostic(`form: ${sum(form)} bytes, ${form.length} files, ${Math.max(...form.map((request) => rounds(form, request)))} round trips`);
  assert.ok(form.length >= 5 && sum(form) > 20e3, table(form));
  assert.ok(sum(form) <= maxForm, `${sum(form)} bytes:\n${table(form)}`);
  assert.ok(form.every((request) => rounds(form, request) <= maxRounds), table(form));

  const {id, model} = await scan(scanner, {snapshots: 8, leaf_size_mm: 1});
  assert.ok(model.bytes > maxSight, `a model that could not be seen so soon: ${model.bytes} bytes`);
  const other = await emptyPage(browser);
  const {all: seen} = await count(other);
  await other.goto(`${scanner.url}#${id}`);
  await other.waitForFunction(() => performance.getEntriesByType('resource').some(({name, responseEnd}) => name.endsWith('/coarse.stl') && responseEnd > 0));
  const sight = seen.filter(({url}) => !url.includes('/preview/') && !url.endsWith('/Scan.stl'));
  t.diagnostic(`first 3D: ${sum(sight)} bytes, of a model of ${model.bytes}`);
  assert.ok(sight.some(({url, bytes}) => url.endsWith('/coarse.stl') && bytes > 10e3), table(sight));
  assert.ok(sum(sight) <= maxSight, `${sum(sight)} bytes:\n${table(sight)}`);
  await other.locator('#tools').waitFor();

  const before = seen.length;
  await other.reload();
  await other.locator('#tools').waitFor();
  const again = seen.slice(before).filter(({url}) => url.includes('/assets/'));
  assert.equal(sum(again), 0, `what is kept for ever came again:\n${table(again)}`);
});
