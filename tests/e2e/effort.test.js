// What the live picture costs the page: its analysis runs in a worker, so that the page answers at once on a slow phone,
// too.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {openBrowser, openPage} from './browser.js';
import {startScanner} from './scanner.js';

const pictures = 12;

/**
 * Processor time of the scripts in the page's threads while some live pictures are shown. Both run on the same machine
 * at the same time, so their ratio does not depend on what else it does.
 * @returns {Promise<Record<'main' | 'worker', number>>} microseconds
 */
async function effortOf(browser, page) {
  await browser.startTracing(page, {categories: ['devtools.timeline', 'v8.execute', '__metadata']});
  for (let picture = 0; picture < pictures; ++picture) {
    await page.waitForResponse('**/api/v1/preview/**');
  }
  const {traceEvents} = JSON.parse(String(await browser.stopTracing()));
  const names = new Map(traceEvents.filter(({name}) => name === 'thread_name')
      .map(({pid, tid, args}) => [`${pid} ${tid}`, args.name]));
  const effort = {main: 0, worker: 0};
  for (const {name, pid, tid, tdur = 0} of traceEvents) {
    const thread = names.get(`${pid} ${tid}`) ?? '';
    if (name === 'FunctionCall' || name === 'RunMicrotasks') {
      effort[thread.startsWith('DedicatedWorker') ? 'worker' : 'main'] += tdur;
    }
  }
  return effort;
}

test('the live picture is analysed beside the page, and not by it', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t, {hasWebGl: false});
  const {page, faults} = await openPage(browser, scanner.url, {screen: 'phone'});
  await page.locator('#live-hint').waitFor();
  const {main, worker} = await effortOf(browser, page);
  t.diagnostic(`scripts: ${main} microseconds of the page, ${worker} of the worker`);
  assert.ok(worker > 0);
  assert.ok(main < worker, `${main} of ${main + worker} microseconds on the page's own thread`);
  assert.deepEqual(faults, []);
});
