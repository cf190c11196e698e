// What lies within the window before anybody scrolls, on screens of all sizes: Start at a first visit, and the result of a scan.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {awaitPlace, openBrowser, openPage, picture} from './browser.js';
import {scan, startScanner} from './scanner.js';

const screens = {phone: [390, 844], small: [360, 640], tablet: [820, 1180], desktop: [1280, 860]};
const shortScreens = {landscape: [844, 390], magnified: [640, 430]};

const clock = {check: 'clock', name: 'Clock', state: 'warning', measured: '2020-01-25 06:22 UTC, not from a time server', action: '',
  advice: 'Connect the scanner to a network with internet, or its scans have wrong dates.'};

/**
 * Opens the page as if the computer had these warnings.
 * @returns {Promise<import('playwright-core').Page>}
 */
async function openWith(browser, url, warnings) {
  const {page} = await openPage(browser, 'about:blank');
  await page.route('**/api/v1/events', (route) => route.abort());
  await page.route('**/api/v1/status', async (route) => {
    const status = await route.fetch().then((response) => response.json()).catch(() => null);
    await (status ? route.fulfill({json: {...status, warnings}}) : route.abort());
  });
  await page.goto(url);
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'});
  return page;
}

/** Gives the window a size, and scrolls to its top. */
async function resize(page, [width, height]) {
  await page.setViewportSize({width, height});
  await page.evaluate(() => scrollTo(0, 0));
}

/** Why an element is not wholly in sight, or an empty text. @param {string} id */
const hiddenPart = (page, id) => page.evaluate((name) => {
  const element = document.getElementById(name);
  const {left, top, right, bottom} = element.getBoundingClientRect();
  const isSeen = (x, y) => element.contains(document.elementFromPoint(x, y));
  const middle = (left + right) / 2;
  return isSeen(middle, top + 3) && isSeen(middle, bottom - 3) ? '' : `#${name} from ${top} to ${bottom} of ${innerHeight}`;
}, id);

const areApart = (page, ...ids) => page.evaluate((names) => {
  const [a, b] = names.map((name) => document.getElementById(name).getBoundingClientRect());
  return a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
}, ids);

/** The part of the model's picture within the window, pixels. */
const pictureInSight = (page) => page.locator('#view').evaluate((view) => {
  const {top, bottom} = view.getBoundingClientRect();
  return Math.min(bottom, innerHeight) - Math.max(top, 0);
});

const sizeOf = (page) => page.locator('#view').evaluate((view) => view.clientHeight);

async function firstVisit(page) {
  await page.locator('#first-steps').waitFor();
  await page.locator('#warnings li').waitFor();
  for (const [name, size] of Object.entries(screens)) {
    await resize(page, size);
    assert.equal(await hiddenPart(page, 'start'), '', name);
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    const lines = await page.evaluate(() => ['#warnings li', '#first-steps'].map((part) => document.querySelector(part).clientHeight));
    assert.ok(lines.every((height) => height < 60), `each is one line, not ${lines} pixels high: ${name}`);
    await picture(page, `first-visit-${name}`);
  }
  assert.deepEqual(await complaints(page), []);
}

/** The words of a list's items that can be seen. */
const wordsIn = (list) => list.evaluate((found) => {
  const isSeen = (element) => element.getBoundingClientRect().width > 1;
  return [...found.children].filter(isSeen).flatMap(({children}) => [...children].filter(isSeen).map((part) => part.textContent)).filter(Boolean);
});

async function devices(page) {
  const list = page.getByRole('list', {name: 'Devices'});
  await resize(page, screens.phone);
  assert.deepEqual(await wordsIn(list), ['ready'], 'one dot and one word for devices that are well');
  await resize(page, screens.desktop);
  assert.equal((await wordsIn(list)).filter((word) => word === 'ready').length, 2);
}

async function warnings(browser, url) {
  const supply = {check: 'supply', name: 'Supply voltage', state: 'warning', measured: '4.5 V', action: '', advice: 'Use another supply.'};
  const now = () => new Date().toISOString().replace('T', ' ').slice(0, 16);
  const told = [supply, {...clock, measured: `${now()} UTC, not from a time server`}];
  const page = await openWith(browser, url, told);
  const lines = page.locator('#warnings li');
  await lines.first().waitFor();
  assert.match((await lines.allInnerTexts()).join(), /^Supply voltage: 4\.5\sV\. Use another supply\.$/, 'a clock that is right is no warning');
  await lines.getByRole('button', {name: 'Supply voltage: 4.5 V.'}).click();
  await lines.getByRole('button', {expanded: true}).waitFor();
  await page.getByRole('button', {name: 'Dismiss: Supply voltage'}).click();
  await page.locator('#warnings').waitFor({state: 'hidden'});
  const seen = async () => {
    await page.waitForResponse('**/api/v1/status');
    await page.waitForResponse('**/api/v1/status');  // what the one before told is shown
    return lines.count();
  };
  await page.reload();
  assert.equal(await seen(), 0, 'this browser keeps it');
  told[0] = {...supply, measured: '4.4 V'};
  assert.equal(await seen(), 0, 'whatever its number is');
  told[0] = {...supply, state: 'fault'};
  await lines.first().waitFor();
  await page.unrouteAll({behavior: 'ignoreErrors'});
  await page.context().close();
}

async function result(page) {
  await page.locator('#tools').waitFor();
  await page.locator('#verdict').waitFor();
  for (const [name, size] of Object.entries({...screens, ...shortScreens})) {
    await resize(page, size);
    for (const id of ['verdict', 'download']) {
      assert.equal(await hiddenPart(page, id), '', name);
    }
    const tools = await page.locator('#tools').evaluate((group) => group.clientHeight);
    assert.ok(tools < 60, `the tools are one row, not ${tools} pixels high: ${name}`);
    const inSight = await pictureInSight(page);
    assert.ok(inSight > await sizeOf(page) - 1 && inSight > 200, `the whole picture, not ${inSight} pixels of it: ${name}`);
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    await picture(page, `result-${name}`);
    if (name === 'desktop') {
      await picture(page, 'page', {fullPage: false});  // README's: web/docs/page.png
    }
  }
  assert.ok(await page.locator('#verdict').evaluate((verdict) => verdict.clientHeight) < 48, 'the verdict is one line');
  await resize(page, screens.desktop);
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  assert.ok(await pictureInSight(page) > 300, 'the picture stays beside what is scrolled');
  assert.deepEqual(await complaints(page), []);
}

/** The model in the colours of the legend: by how many snapshots each place was seen. */
async function views(page) {
  const button = page.getByRole('button', {name: 'Show by how many snapshots each place was seen'});
  await resize(page, screens.desktop);
  const clay = await page.locator('#view').screenshot();
  const answer = page.waitForResponse(/Scan\.ply\?colour=views/);
  await button.click();
  const ply = await (await answer).body();
  await page.locator('#legend').waitFor();
  await page.locator('#measured').waitFor({state: 'hidden'});
  const legend = await page.locator('#legend li').evaluateAll((items) =>
    items.map((item) => getComputedStyle(item, '::before').backgroundColor));
  const first = ply.indexOf('end_header\n') + 'end_header\n'.length;
  const counts = new Map(legend.map((colour) => [colour, 0]));
  for (let vertex = 0; vertex < Number(/element vertex (\d+)/.exec(ply.toString('latin1', 0, first))[1]); ++vertex) {
    const colour = `rgb(${[...ply.subarray(first + 15 * vertex + 12, first + 15 * vertex + 15)].join(', ')})`;
    assert.ok(counts.has(colour), `${colour} is not in the legend: ${legend}`);
    counts.set(colour, counts.get(colour) + 1);
  }
  assert.ok([...counts.values()].filter((count) => count > 20).length >= 4, `${[...counts]}`);
  assert.ok(!clay.equals(await page.locator('#view').screenshot()), 'it is painted');
  const {phone, small, desktop} = screens;
  for (const [name, size] of Object.entries({phone, small, low: [375, 553], desktop, ...shortScreens})) {
    await resize(page, size);
    assert.equal(await hiddenPart(page, 'legend'), '', name);
    await picture(page, `views-${name}`, {fullPage: false});
    await page.locator('#cut').click();
    assert.deepEqual(await Promise.all(['legend', 'cut-place'].map((id) => hiddenPart(page, id))), ['', ''], name);
    for (const id of ['cut-axes', 'cut-place', 'make-model']) {
      assert.ok(await areApart(page, 'legend', id), `${id}: ${name}`);
    }
    await page.locator('#cut').click();
  }
  for (const [name, size] of Object.entries({...shortScreens, between: [900, 800], desktop})) {
    await resize(page, size);
    await page.locator('#measure').click();
    assert.equal(await hiddenPart(page, 'measured'), '', name);
    assert.ok(await page.locator('#measured').evaluate(({clientWidth}) => clientWidth) > 150, name);
    await page.locator('#measure').click();
  }
  assert.deepEqual(await complaints(page), []);
  await button.click();
  await page.locator('#legend').waitFor({state: 'hidden'});
}

/** All texts grow with the browser's font size, and nothing is cut off by that. */
async function largeLetters(page, states) {
  for (const [name, size] of Object.entries({phone: screens.phone, desktop: screens.desktop})) {
    await resize(page, size);
    const letters = () => page.evaluate(() => ['body', 'h1', '.primary', '.muted'].map((part) =>
      parseFloat(getComputedStyle(document.querySelector(part)).fontSize)));
    const usual = await letters();
    const setSize = (value) => page.evaluate((given) => {
      document.documentElement.style.fontSize = given;
    }, value);
    await setSize('150%');
    assert.deepEqual(await letters(), usual.map((pixels) => 1.5 * pixels));
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    await picture(page, `${states}-large-${name}`);
    await setSize('');
  }
}

/** In a browser whose user has set letters of twice the size, a phone has verdict and Download in its window. */
async function largestLetters(t, url) {
  const {page} = await openPage(await openBrowser(t, {hasWebGl: false, letters: 32}), url, {screen: 'phone'});
  await page.locator('#verdict').waitFor();
  for (const [name, size] of Object.entries({usual: [360, 740], phone: screens.phone})) {
    await resize(page, size);
    assert.equal(await page.evaluate(() => getComputedStyle(document.documentElement).fontSize), '32px');
    for (const id of ['verdict', 'download']) {
      assert.equal(await hiddenPart(page, id), '', name);
    }
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    await picture(page, `result-largest-${name}`, {fullPage: false});
  }
  await page.goto(new URL('/', url).href);
  await page.locator('#start').waitFor();
  for (const [name, size] of Object.entries({usual: [360, 740], phone: screens.phone})) {
    await resize(page, size);
    assert.equal(await hiddenPart(page, 'start'), '', name);
    await page.locator('#all-settings').evaluate((details) => { details.open = true; });
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    await picture(page, `form-largest-${name}`, {fullPage: false});
  }
  await resize(page, [360, 740]);
  for (const place of ['library', 'scanner', 'calibrate', 'settings']) {
    await page.goto(new URL(`/#${place}`, url).href);
    await awaitPlace(page, place);
    await page.locator(place === 'settings' ? '#cards' : 'main:not([hidden]) h1').waitFor();
    assert.ok(await overflow(page) <= 0, `${place} is ${await overflow(page)} pixels too wide`);
    await picture(page, `${place}-largest`);
  }
  await page.context().close();
}

/** A page in a tab that nobody looks at, which notes the sounds that it plays. */
async function openHidden(browser, url) {
  const {page} = await openPage(browser, 'about:blank');
  await page.addInitScript(() => {
    globalThis.sounds = 0;
    globalThis.isHidden = true;
    localStorage.setItem('octurn-sound', 'yes');
    Object.defineProperty(document, 'hidden', {get: () => globalThis.isHidden});
    const Sound = AudioContext;
    globalThis.AudioContext = class extends Sound {
      constructor() {
        super();
        globalThis.sounds += 1;
      }
    };
  });
  await page.goto(url);
  await page.locator('[data-panel=form]').waitFor();
  return page;
}

/** The end of a scan is marked on a hidden tab, until it is looked at, and heard where that was chosen. */
async function seeEnd(page) {
  await page.waitForFunction(() => document.title.startsWith('✓ '));
  assert.match(await page.locator('link[rel=icon]').getAttribute('href'), /done/);
  assert.equal(await page.evaluate(() => globalThis.sounds), 1);
  await page.evaluate(() => {
    globalThis.isHidden = false;
    document.dispatchEvent(new Event('visibilitychange'));
  });
  assert.doesNotMatch(await page.title(), /✓/);
  assert.doesNotMatch(await page.locator('link[rel=icon]').getAttribute('href'), /done/);
  await page.context().close();
}

/**
 * A wall on the platform, 100 mm wide, as a binary STL.
 * @param {number} height  millimetres @param {number} columns  of squares @param {number} rows
 */
function wall(height, columns, rows) {
  const triangles = 2 * columns * rows;
  const file = Buffer.alloc(84 + 50 * triangles);
  file.writeUInt32LE(triangles, 80);
  for (let index = 0; index < triangles; ++index) {
    const square = index >> 1;
    const [column, row] = [square % columns, Math.floor(square / columns)];
    const corners = index % 2 === 0 ? [[0, 0], [1, 0], [1, 1]] : [[0, 0], [1, 1], [0, 1]];
    corners.forEach(([right, up], corner) => {
      const [x, z] = [100 * (column + right) / columns - 50, height * (row + up) / rows];
      [x, 0, z].forEach((value, axis) => file.writeFloatLE(value, 84 + 50 * index + 12 + 12 * corner + 4 * axis));
    });
  }
  return file;
}

/** The number of the view's pixels in the model's warm colour, on a bluish background. */
async function modelPixels(page) {
  const png = await page.locator('#view').screenshot();
  return page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (byte) => byte.charCodeAt(0))]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const {data} = context.getImageData(0, 0, bitmap.width, bitmap.height);
    return data.filter((red, i) => i % 4 === 0 && red > 60 && red > data[i + 2]).length;
  }, png.toString('base64'));
}

/** A large model's coarse mesh, here a wall of a third of its height, is drawn only while a pointer drags it. */
async function dragLarge(browser, url, id) {
  const {page} = await openPage(browser, 'about:blank');
  await page.route('**/Scan.stl', (route) => route.fulfill({body: wall(90, 320, 320), contentType: 'model/stl'}));
  await page.route('**/coarse.stl', (route) => route.fulfill({body: wall(30, 1, 1), contentType: 'model/stl'}));
  await page.goto(`${url}#${id}`);
  await page.locator('#tools').waitFor();
  const whole = await modelPixels(page);
  assert.ok(whole > 1000, `${whole}`);
  const {x, y, width, height} = await page.locator('#view').boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 2, y + height / 2);
  while (await modelPixels(page) > 0.6 * whole) {
    // the frame with the coarse mesh is not drawn yet
  }
  await page.mouse.up();
  while (await modelPixels(page) < 0.9 * whole) {
    // nor the one with the model
  }
  await page.context().close();
}

test('what matters is in sight on every screen', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  const page = await openWith(browser, scanner.url, [clock]);
  await t.test('Start at a first visit, below one warning', () => firstVisit(page));
  await t.test('the devices that are well, as one dot on a phone', () => devices(page));
  await page.unrouteAll({behavior: 'ignoreErrors'});
  await page.context().close();
  await t.test('warnings, until they are dismissed', () => warnings(browser, scanner.url));
  const hidden = await openHidden(browser, scanner.url);
  const {id} = await scan(scanner, {snapshots: 8, leaf_size_mm: 2});
  await t.test('the end of a scan, on its tab', () => seeEnd(hidden));
  const opened = await openPage(browser, `${scanner.url}#${id}`);
  await t.test('model, verdict and Download at the end of a scan', () => result(opened.page));
  await t.test('the model by how many snapshots saw each place', () => views(opened.page));
  await t.test('all of it in large letters', () => largeLetters(opened.page, 'result'));
  await t.test('verdict and Download in the largest letters', () => largestLetters(t, `${scanner.url}#${id}`));
  assert.deepEqual(opened.faults, []);
  await opened.page.context().close();
  await t.test('a large model that is dragged, by its coarse mesh', () => dragLarge(browser, scanner.url, id));
});
