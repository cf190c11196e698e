// Measures a library of many scans: time and bytes of GET scans, and of the page that shows and scrolls them in headless Chromium
// the time of its main thread, the tasks longer than 50 ms, and the late frames.
//
//   node tests/bench/library.mjs BUILD_FOLDER [SCANS]   with the page's tests built in it (target octurn_e2e); 1000 scans

import {existsSync, renameSync, rmSync} from 'node:fs';
import {request} from 'node:http';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {copyScan, idOf} from '../attack/scans.mjs';

const [build, scans = '1000'] = process.argv.slice(2);
if (!build || !existsSync(join(build, 'tests/e2e/browser.js')) || !(Number(scans) > 0)) {
  process.stderr.write('usage: node tests/bench/library.mjs BUILD_FOLDER [SCANS]\nBUILD_FOLDER has had the target octurn_e2e built.\n');
  process.exit(1);
}
process.env.OCTURN_PROGRAM ??= resolve(build, 'bin/octurn');
const tested = (name) => import(pathToFileURL(resolve(build, 'tests/e2e', name)).href);
const {openBrowser, openPage} = await tested('browser.js');
const {ask, scan, startScanner} = await tested('scanner.js');

const turns = 40;  // turns of the mouse wheel
const ends = [];
const t = {after: (end) => ends.unshift(end)};
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Requests a URL. @returns {Promise<{ms: number, bytes: number}>} duration, and bytes as transferred */
const answer = (url, headers) => new Promise((done, fail) => {
  const begin = performance.now();
  let bytes = 0;
  request(url, {headers, agent: false}, (response) => response.on('data', (part) => {
    bytes += part.length;
  }).on('end', () => done({ms: performance.now() - begin, bytes, status: response.statusCode}))).on('error', fail).end();
});

async function tellAnswers(scanner) {
  const url = `${scanner.url}api/v1/scans`;
  for (const [name, headers] of [['plain', {}], ['gzip', {'Accept-Encoding': 'gzip'}]]) {
    const answers = [];
    for (let i = 0; i < 9; ++i) {
      answers.push(await answer(url, headers));
    }
    console.log(`GET scans, ${name}: ${median(answers.map(({ms}) => ms)).toFixed(1)} ms, ${answers[0].bytes} bytes`);
  }
  const {headers} = await fetch(url);
  const unchanged = await answer(url, {'If-None-Match': headers.get('ETag')});
  console.log(`GET scans, unchanged: ${unchanged.ms.toFixed(1)} ms, ${unchanged.status}, ${unchanged.bytes} bytes`);
}

/** Runs an action on the page, and prints its cost. */
async function tell(page, session, name, action) {
  const seconds = async () => {
    const {metrics} = await session.send('Performance.getMetrics');
    const of = (key) => metrics.find((metric) => metric.name === key).value;
    return {main: of('TaskDuration'), script: of('ScriptDuration'), layout: of('LayoutDuration') + of('RecalcStyleDuration')};
  };
  await page.evaluate(() => {
    const seen = {frames: [], tasks: []};
    globalThis.seen = seen;
    let before = performance.now();
    const frame = (now) => {
      seen.frames.push(now - before);
      before = now;
      globalThis.seen === seen && requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
    new PerformanceObserver((entries) => seen.tasks.push(...entries.getEntries().map(({duration}) => duration))).observe({type: 'longtask'});
  });
  const before = await seconds();
  const begin = performance.now();
  await action();
  const ms = performance.now() - begin;
  const after = await seconds();
  const {frames, tasks} = await page.evaluate(() => {
    const {seen} = globalThis;
    globalThis.seen = null;
    return seen;
  });
  const cost = (key) => `${Math.round(1000 * (after[key] - before[key]))} ms`;
  const late = frames.filter((interval) => interval > 25).length;  // at 16.7 ms a frame, at least one was dropped
  console.log(`${name}: ${Math.round(ms)} ms; main thread ${cost('main')}, of it script ${cost('script')}, style and layout ${cost('layout')}; ` +
    `${tasks.length} long tasks, ${Math.round(Math.max(0, ...tasks))} ms the longest; ${late} of ${frames.length} frames late`);
}

/** Scrolls from the top to the end with the mouse wheel. */
async function scroll(page) {
  const height = await page.evaluate(() => document.documentElement.scrollHeight - innerHeight);
  await page.evaluate(() => scrollTo(0, 0));
  for (let turn = 0; turn < turns; ++turn) {
    await page.mouse.wheel(0, Math.ceil(height / turns));
    await page.evaluate(() => new Promise(requestAnimationFrame));
  }
}

async function tellPage(scanner, screen) {
  const {page} = await openPage(await openBrowser(t, {hasWebGl: false}), scanner.url, {screen});
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const count = () => page.locator('#rows > li').count();
  await page.mouse.move(200, 400);
  await tell(page, session, `${screen}, library opened`, async () => {
    await page.evaluate(() => { location.hash = 'library'; });
    await page.locator('#rows > li').first().waitFor();
  });
  await tell(page, session, `${screen}, ${await count()} cards scrolled`, () => scroll(page));
  await tell(page, session, `${screen}, search typed`, async () => {
    await page.getByRole('searchbox').pressSequentially('2020 1', {delay: 60});
    await page.getByRole('searchbox').fill('');
  });
  await tell(page, session, `${screen}, all shown`, async () => {
    while (await page.locator('#show-more').isVisible()) {
      await page.locator('#show-more').evaluate((button) => button.click());
      await page.evaluate(() => new Promise(requestAnimationFrame));
    }
  });
  await tell(page, session, `${screen}, ${await count()} cards scrolled`, () => scroll(page));
  await page.context().close();
}

try {
  const scanner = await startScanner(t);
  const {id} = await scan(scanner, {snapshots: 4, leaf_size_mm: 4, filter: 'basic'});
  await scanner.end();
  const folder = join(scanner.data, 'scans');
  const template = join(scanner.data, 'template');
  renameSync(join(folder, id), template);
  for (let i = 0; i < Number(scans); ++i) {
    copyScan(template, join(folder, idOf(i)));
  }
  rmSync(template, {recursive: true});
  await scanner.restart();
  console.log(`${(await ask(scanner, 'scans')).scans.length} scans`);
  await tellAnswers(scanner);
  await tellPage(scanner, 'desktop');
  await tellPage(scanner, 'phone');
} finally {
  for (const end of ends) {
    await end();
  }
}
