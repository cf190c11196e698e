// Debian's headless Chromium.

import {mkdir} from 'node:fs/promises';
import {after} from 'node:test';
import {join} from 'node:path';
import {chromium} from 'playwright-core';

const noBackgroundTraffic = ['--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run'];
// WebGL by software, which would take twice the time to draw the rest of the page, too.
const softwareWebGl = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-compositing'];
const noWebGl = ['--disable-gpu', '--disable-software-rasterizer', '--disable-3d-apis'];

const screens = {
  desktop: {viewport: {width: 1280, height: 860}},
  phone: {viewport: {width: 390, height: 844}, deviceScaleFactor: 2, isMobile: true, hasTouch: true},
};

/**
 * By options: one for all tests of a file, as a start takes a second.
 * @type {Map<string, Promise<import('playwright-core').Browser>>}
 */
const browsers = new Map();
after(() => Promise.all([...browsers.values()].map(async (browser) => (await browser).close())));

/**
 * @param {import('node:test').TestContext} t  at its end all pages are closed
 * @param {{hasWebGl?: boolean, letters?: number}} options  letters: the font size that its user has set, pixels
 */
export async function openBrowser(t, {hasWebGl = true, letters = 16} = {}) {
  const key = `${hasWebGl} ${letters}`;
  const opened = browsers.get(key) ?? chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium-headless-shell',
    args: [`--blink-settings=defaultFontSize=${letters}`, ...noBackgroundTraffic, ...(hasWebGl ? softwareWebGl : noWebGl), ...(process.getuid?.() === 0 ? ['--no-sandbox'] : [])],
  });
  browsers.set(key, opened);
  const browser = await opened;
  t.after(() => Promise.all(browser.contexts().map((context) => context.close())));
  return browser;
}

/** On a busy machine the simulated sensor may have no frame in time: the daemon answers 503, and the page asks again. */
const isLatePicture = (message) => message.location().url.includes('/api/v1/preview/') && message.text().includes('503');

/**
 * An empty page with storage and cache of its own, without animations, which would be drawn sixty times a second.
 *
 * @typedef {{screen?: 'desktop' | 'phone', colorScheme?: 'light' | 'dark', locale?: string, password?: string}} Visitor  password: of the page
 * @param {import('playwright-core').Browser} browser
 * @param {Visitor} visitor
 */
export async function emptyPage(browser, {screen = 'desktop', colorScheme = 'light', locale = 'en-US', password} = {}) {
  const context = await browser.newContext({...screens[screen], colorScheme, locale, reducedMotion: 'reduce',
    httpCredentials: password === undefined ? undefined : {username: 'octurn', password}});
  const page = await context.newPage();
  page.setDefaultTimeout(600000); // a busy machine takes minutes for what a scan or a calibration works out
  return page;
}

/**
 * Opens the page and waits until it shows the scanner.
 *
 * @param {import('playwright-core').Browser} browser
 * @param {string} url
 * @param {Visitor} visitor
 * @returns {Promise<{page: import('playwright-core').Page, faults: string[]}>}  faults: the errors so far, such as errors
 *     on the console and requests to other hosts
 */
export async function openPage(browser, url, visitor = {}) {
  const page = await emptyPage(browser, visitor);
  const faults = [];
  page.on('console', (message) => message.type() === 'error' && !isLatePicture(message) && faults.push(message.text()));
  page.on('pageerror', (error) => faults.push(error.message));
  page.context().on('request', (request) => {
    const {origin, protocol} = new URL(request.url());
    if (origin !== new URL(url).origin && protocol !== 'blob:' && protocol !== 'data:') {
      faults.push(`request to ${request.url()}`);
    }
  });
  await page.goto(url);
  await page.locator('[data-panel=waiting]').waitFor({state: 'hidden'});
  return {page, faults};
}

const laterPlaces = ['library', 'scanner', 'calibrate', 'settings'];

/** Waits until a place of the page is loaded. @param {string} hash  of its address, without '#'; any other hash names a scan */
export const awaitPlace = (page, hash) =>
  page.locator(`main[data-place=${laterPlaces.includes(hash) ? hash : 'scan'}]:not([hidden], [aria-busy], :has([aria-busy]))`).waitFor();

/** Goes to a place of the page by its links, and waits until it is loaded. @param {'Scan' | 'Library' | 'Scanner' | 'Calibrate' | 'Settings'} place */
export async function goTo(page, place) {
  const link = (name) => page.getByRole('navigation').getByRole('link', {name, exact: true});
  if (place === 'Calibrate' || place === 'Settings') {
    await link('Scanner').click();
  }
  await link(place).click();
  await awaitPlace(page, place.toLowerCase());
}

/** Opens the settings behind the presets. */
export const openSettings = (page) => page.locator('#all-settings').evaluate((details) => {
  details.open = true;
});

/** Fills the form for a quick scan. */
export async function chooseQuickScan(page, snapshots) {
  await openSettings(page);
  await page.getByLabel('Snapshots per turn', {exact: true}).fill(String(snapshots));
  await page.getByLabel('Draft').check();
  await page.getByLabel('Depth filter').selectOption('basic');
}

/** Stores a screenshot of the page, or of what its window shows. */
export async function picture(page, name, {fullPage = true} = {}) {
  const where = process.env.OCTURN_PICTURES;
  if (!where) {
    throw new Error('OCTURN_PICTURES must be a folder for pictures');
  }
  await mkdir(where, {recursive: true});
  await page.screenshot({path: join(where, `${name}.png`), fullPage});
}

/**
 * The rows of the 3D view that show the model, from the top: each row's longest run of the model's warm colour, on a bluish
 * background.
 *
 * @returns {Promise<{share: number, rows: {y: number, first: number, end: number}[]}>}  share: of the view's pixels in that colour
 */
async function modelSeen(page) {
  const png = await page.locator('#view').screenshot();
  return page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (byte) => byte.charCodeAt(0))]));
    const {width, height} = bitmap;
    const context = new OffscreenCanvas(width, height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const {data} = context.getImageData(0, 0, width, height);
    const rows = [];
    let warm = 0;
    for (let y = 0; y < height; ++y) {
      let longest = {y, first: 0, end: 0};
      for (let x = 0, first = 0; x < width; ++x) {
        const i = 4 * (y * width + x);
        const isWarm = data[i] > 60 && data[i] > data[i + 2];
        warm += isWarm ? 1 : 0;
        first = isWarm ? first : x + 1;
        longest = x + 1 - first > longest.end - longest.first ? {y, first, end: x + 1} : longest;
      }
      if (longest.end > longest.first) {
        rows.push(longest);
      }
    }
    return {share: warm / (width * height), rows};
  }, png.toString('base64'));
}

/** The share of the 3D view's pixels that show the model. */
export const modelShare = async (page) => (await modelSeen(page)).share;

/** Clicks on the model at a share of its visible rows from the top, as the view's height depends on the texts beside it. */
export async function clickModel(page, share) {
  const {rows} = await modelSeen(page);
  const {y, first, end} = rows[Math.floor(share * rows.length)];
  await page.locator('#view').click({position: {x: (first + end) / 2, y}});
}
