import assert from 'node:assert/strict';
import {test} from 'node:test';

import {openBrowser, openPage, openSettings, picture} from './browser.js';
import {startScanner} from './scanner.js';

/** The share of the live picture's pixels that are coloured, not grey. */
const colouredShare = (page) => page.locator('#depth').evaluate((canvas) => {
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let coloured = 0;
  for (let i = 0; i < data.length; i += 4) {
    coloured += data[i + 3] > 0 && data[i] !== data[i + 2] ? 1 : 0;
  }
  return 4 * coloured / data.length;
});

const waitForHint = (page, code) => page.locator(`#live-hint[data-code=${code}]`).waitFor();

for (const screen of ['desktop', 'phone']) {
  test(`on a ${screen} the live picture colours what will be scanned, and says what would spoil it`, async (t) => {
    const scanner = await startScanner(t);
    const {page, faults} = await openPage(await openBrowser(t), scanner.url, {screen});
    await waitForHint(page, 'good');
    assert.match(await page.locator('#live-hint').innerText(), /Ready to scan\s+Seen: \d+\scm wide, \d+\scm high, \d+\scm away\./);
    const share = await colouredShare(page);
    assert.ok(share > 0.01 && share < 0.4, `the object in colour and the rest grey, not ${share}`);
    assert.ok((await page.locator('#live-lines [data-line=ring]').getAttribute('d')).length > 100, 'the platform is drawn in');
    await picture(page, `live-${screen}`);

    await openSettings(page);
    await page.getByLabel('Up, to').fill('60');
    await waitForHint(page, 'cut-top');
    await picture(page, `live-cut-${screen}`);
    await page.getByLabel('Up, to').fill('400');
    await waitForHint(page, 'good');
    await page.getByLabel('Up, from').fill('390');
    await waitForHint(page, 'empty');

    await page.locator('#depth').hover({position: {x: 100, y: 100}});
    assert.match(await page.locator('#live-pointed').innerText(), /cm|2\sm or more|No reading/);
    assert.deepEqual(faults, []);
  });
}

test('a browser whose workers have no canvas, such as Safari 16.0, reads the live picture itself', async (t) => {
  const scanner = await startScanner(t);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  await page.addInitScript(() => delete globalThis.OffscreenCanvas);
  await page.reload();
  await waitForHint(page, 'good');
  const share = await colouredShare(page);
  assert.ok(share > 0.01 && share < 0.4, `the object in colour and the rest grey, not ${share}`);
  assert.equal(page.workers().length, 0);
  assert.deepEqual(faults, []);
});
