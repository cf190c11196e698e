// What the live picture costs the page: its analysis runs in a worker, so that the page answers at once on a slow phone,
// too.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {openBrowser, openPage} from './browser.js';
import {startScanner} from './scanner.js';

const pictures = 12;
const slowdown = 4;     // of the processor, to that of a slow phone
const interval = 250e3;  // microseconds from a live picture to the next
const maxShare = 0.25;  // of that, by the page's own scripts on the main thread
const maxTask = 200e3;  // microseconds

/**
 * Traces the browser while some live pictures are shown.
 * @returns {Promise<{name: string, thread: string, ts: number, dur?: number, tdur?: number}[]>} microseconds; tdur: of
 *     processor time, which does not depend on what else the machine does
 */
async function traceOf(browser, page) {
  await browser.startTracing(page, {categories: ['devtools.timeline', 'v8.execute', 'toplevel', '__metadata']});
  for (let picture = 0; picture < pictures; ++picture) {
    await page.waitForResponse('**/api/v1/preview/**');
  }
  const {traceEvents} = JSON.parse(String(await browser.stopTracing()));
  const names = new Map(traceEvents.filter(({name}) => name === 'thread_name')
      .map(({pid, tid, args}) => [`${pid} ${tid}`, args.name]));
  return traceEvents.filter(({ph}) => ph === 'X')
      .map(({name, pid, tid, ts, dur, tdur}) => ({name, ts, dur, tdur, thread: names.get(`${pid} ${tid}`) ?? ''}));
}

const isMain = ({thread}) => thread === 'CrRendererMain';
const isWorker = ({thread}) => thread.startsWith('DedicatedWorker');

/** Processor time of scripts, microseconds. What a script calls is part of it. */
function scriptsIn(events) {
  let end = 0;
  return events.filter(({name}) => name === 'FunctionCall' || name === 'RunMicrotasks')
      .sort((a, b) => a.ts - b.ts)
      .reduce((sum, {ts, dur = 0, tdur = 0}) => {
        const isCalled = ts < end;
        end = Math.max(end, ts + dur);
        return sum + (isCalled ? 0 : tdur);
      }, 0);
}

async function openForm(t) {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t, {hasWebGl: false});
  const {page, faults} = await openPage(browser, scanner.url, {screen: 'phone'});
  await page.locator('#live-hint').waitFor();
  return {browser, page, faults};
}

test('the live picture is analysed beside the page, and not by it', async (t) => {
  const {browser, page, faults} = await openForm(t);
  const events = await traceOf(browser, page);
  const [main, worker] = [isMain, isWorker].map((isThread) => scriptsIn(events.filter(isThread)));
  t.diagnostic(`scripts: ${main} microseconds of the page, ${worker} of the worker`);
  assert.ok(worker > 0);
  assert.ok(main < worker, `${main} of ${main + worker} microseconds on the page's own thread`);
  assert.deepEqual(faults, []);
});

test('with the live picture on, a processor four times as slow has time left, and no task delays an answer',
    async (t) => {
      const {browser, page, faults} = await openForm(t);
      const session = await page.context().newCDPSession(page);
      await session.send('Emulation.setCPUThrottlingRate', {rate: slowdown});
      const events = (await traceOf(browser, page)).filter(isMain);
      const share = scriptsIn(events) / (pictures * interval);
      const tasks = events.filter(({name}) => name.endsWith('RunTask')).map(({tdur = 0}) => tdur);
      const longest = Math.max(...tasks);
      t.diagnostic(`scripts: ${(100 * share).toFixed(1)} % of a picture's time; longest of ${tasks.length} tasks ` +
        `${longest / 1000} ms`);
      assert.ok(share > 0.002 && tasks.length > pictures, 'it is the page that was traced');
      assert.ok(share <= maxShare, `${share} of a picture's time`);
      assert.ok(longest > 1000, `the tasks have durations, not ${longest} microseconds`);
      assert.ok(longest <= maxTask, `a task of ${longest} microseconds`);
      assert.deepEqual(faults, []);
    });
