// The page Calibrate, on a rig whose told pose is off.

import assert from 'node:assert/strict';
import {test} from 'node:test';

import {complaints, overflow} from './access.js';
import {goTo, openBrowser, openPage, picture} from './browser.js';
import {ask, quick, scan, startScanner} from './scanner.js';
import {poseOf} from '../../web/base/pose.js';
import {measure} from '../web/mesh_file.js';

// Off the simulated sensor's pose: its axis by 2 cm, its direction by 2 degrees.
const crooked = {x_mm: 12, y_mm: -604, z_mm: 356, tilt_deg: 26.8, roll_deg: 0.9, yaw_deg: 0};

// Dimensions of the built-in object, millimetres: the flag's end, and the top of the aerial's knob.
const flagEnd = 91;
const knobTop = 155.5;

// Millimetres: leaves of 1 mm, the sensor's noise, and its fixed error of 1 mm.
const tolerance = 3;

/** @returns {Promise<import('./scanner.js').Scanner>} whose configured pose is the crooked one */
async function startCrooked(t) {
  const scanner = await startScanner(t, quick);
  await ask(scanner, 'calibration', 'PATCH', {platform_from_sensor: poseOf(crooked)});
  return scanner;
}

/** A model's highest point within 8 mm of the aerial, and the waved flag's farthest point. @param {Buffer} stl */
function partsOf(stl) {
  let aerial = 0;
  for (let at = 84; at < stl.length; at += 50) {
    for (const corner of [12, 24, 36]) {
      const [x, y, z] = [0, 4, 8].map((byte) => stl.readFloatLE(at + corner + byte));
      aerial = Math.hypot(x, y - 4) < 8 ? Math.max(aerial, z) : aerial;
    }
  }
  return {aerial, flag: measure(stl).max[0]};
}

const modelOf = async (scanner, {model}) => Buffer.from(await (await fetch(new URL(model.url, scanner.url))).arrayBuffer());

const draft = {snapshots: 8, leaf_size_mm: 4};
const whole = {snapshots: 24, leaf_size_mm: 1};  // with fewer snapshots the flag, which is thin, has no end, and no verdict is good

test('a crooked rig is calibrated on the page, and its models have flag and aerial', async (t) => {
  const scanner = await startCrooked(t);
  const told = await scan(scanner, {...whole, calibrate: 'told'});
  assert.notEqual(told.model.quality.verdict, 'good');
  const {page, faults} = await openPage(await openBrowser(t), `${scanner.url}#${told.id}`);
  await picture(page, 'crooked-model');
  await page.locator('#verdict-more').getByRole('link', {name: 'Calibrate'}).first().click();

  await page.getByRole('button', {name: 'Measure with a turn'}).click();
  await page.getByRole('progressbar', {name: 'Measuring with a turn'}).waitFor();
  await page.getByText(/^The axis was \d+\.\d\smm and \d\.\d\d° off$/).waitFor();
  const calibration = await ask(scanner, 'calibration');
  assert.equal(calibration.source, 'turn');
  assert.ok(calibration.after_mm < 1.2 && calibration.after_mm < calibration.before_mm);
  await page.getByRole('img', {name: 'The same slice with the pose that was found'}).waitFor();
  await picture(page, 'calibrated');

  const right = await scan(scanner, {...whole, calibrate: 'told'});
  const {aerial, flag} = partsOf(await modelOf(scanner, right));
  assert.ok(Math.abs(aerial - knobTop) < tolerance, `the aerial ends at ${aerial} mm`);
  assert.ok(Math.abs(flag - flagEnd) < tolerance, `the flag ends at ${flag} mm`);
  await page.goto(`${scanner.url}#${right.id}`);
  await page.locator('#tools').waitFor();
  await picture(page, 'calibrated-model');
  assert.deepEqual(faults, []);
});

test('with the pose checked by each scan even the first has flag and aerial', async (t) => {
  const scanner = await startCrooked(t);
  const {aerial, flag} = partsOf(await modelOf(scanner, await scan(scanner, {...whole, calibrate: 'auto'})));
  assert.ok(Math.abs(aerial - knobTop) < tolerance, `the aerial ends at ${aerial} mm`);
  assert.ok(Math.abs(flag - flagEnd) < tolerance, `the flag ends at ${flag} mm`);
});

const hasFinding = (scan) => scan.calibration.findings.some(({code}) => code === 'no-map');

test('the sensor is flattened on the page, and the next scan sees evenly', async (t) => {
  const scanner = await startScanner(t, quick);
  const first = await scan(scanner, draft);
  assert.ok(hasFinding(first));
  const {page, faults} = await openPage(await openBrowser(t), `${scanner.url}#${first.id}`);
  await page.locator('#verdict-more').getByRole('link', {name: 'Correct the sensor’s unevenness'}).click();

  const look = page.getByRole('button', {name: 'Look at the wall'});
  await page.getByText('Not done for this sensor.').waitFor();
  await page.getByText(/It has been on for/).waitFor();
  await look.click({force: true});  // does nothing before both are ticked
  for (const box of await page.locator('#wall-ready').getByRole('checkbox').all()) {
    await box.check();
  }
  assert.equal((await ask(scanner, 'calibration')).run, null);
  await look.click();
  await page.getByText('The sensor’s unevenness is corrected').waitFor();
  await page.getByRole('img', {name: 'Where the sensor sees too near, and where too far'}).waitFor();
  await picture(page, 'flattened');
  assert.deepEqual(await complaints(page), []);

  const second = await scan(scanner, draft);
  assert.ok(!hasFinding(second));
  await page.getByRole('button', {name: 'Remove the map'}).click();
  await page.getByText('Not done for this sensor.').waitFor();
  assert.equal((await ask(scanner, 'calibration')).sensor_map, null);
  assert.deepEqual(faults, []);
});

const slipped = {
  accepted: true, reason: '', platform_from_sensor: poseOf(crooked), shift_mm: 18.42, tilt_deg: 2.01, sigma_mm: 0.03, sigma_deg: 0.01,
  before_mm: 6.84, after_mm: 0.52, stops: Array.from({length: 24}, (_, stop) => ({angle_deg: 15 * stop, off_deg: stop < 10 ? 0.1 : 1.84})),
  findings: [{code: 'slip', detail: 'stop 10 is 1.84 degrees off', hint: 'Look whether the platform slipped.', stop: 10, deg: 1.84}],
  slice_mm: {before: [[40, 0], [41, 3], [-40, 2], [0, 44]], after: [[40, 0], [40, 3], [-40, 2], [0, 40]]},
};
const run = {kind: 'turn', state: 'running', phase: 'turning', stop: 7, stops: 24, report: null, error: null};

/** Calibration runs as the API reports them, and a text that the page then shows. @type {Record<string, [object | null, string]>} */
const runs = {
  idle: [null, 'Measure with a turn'],
  turning: [run, 'Stop 8 of 24'],
  solving: [{...run, phase: 'solving', stop: 24}, 'Working out where the sensor stands'],
  slipped: [{...run, state: 'done', report: slipped}, 'Stop 10 is 1.84 degrees off.'],
  refused: [{...run, state: 'refused', report: {...slipped, accepted: false, reason: 'too little of an object was seen', stops: [], findings: [], slice_mm: undefined}},
    'Too little of an object was seen.'],
  cancelled: [{...run, state: 'cancelled'}, 'Cancelled'],
  wall: [{...run, kind: 'wall', phase: 'looking', stops: 25}, 'Looking at the wall, 7 of 25'],
};

/** Goes through all runs on one screen. */
async function walk(scanner, browser, screen, colorScheme) {
  const {page} = await openPage(browser, scanner.url, {screen, colorScheme});
  let shown = runs.idle[0];
  await page.route('**/api/v1/calibration', async (route) => route.fulfill({json: {...await (await route.fetch()).json(), run: shown}}));
  await goTo(page, 'Calibrate');
  await page.locator('#pose-no-picture').waitFor({state: 'hidden'});
  for (const [name, [next, text]] of Object.entries(runs)) {
    shown = next;
    await page.getByText(text, {exact: true}).waitFor();
    assert.deepEqual(await complaints(page), [], name);
    assert.ok(await overflow(page) <= 0, `${name} is ${await overflow(page)} pixels too wide`);
    await picture(page, `calibrate-${name}-${screen}-${colorScheme}`);
  }
  await page.unrouteAll({behavior: 'ignoreErrors'});  // a request may be pending
  await page.context().close();
}

test('the page Calibrate is for everyone', async (t) => {
  const scanner = await startScanner(t);
  const browser = await openBrowser(t);
  for (const [screen, colorScheme] of [['desktop', 'light'], ['phone', 'dark']]) {
    await t.test(`${screen}, ${colorScheme}`, () => walk(scanner, browser, screen, colorScheme));
  }
});

test('a first visit is led from the check to the calibration to the scan', async (t) => {
  const scanner = await startScanner(t, quick);
  const {page, faults} = await openPage(await openBrowser(t), scanner.url);
  const steps = page.locator('#first-steps');
  const state = (name) => steps.locator(`[data-step=${name}]`).getAttribute('data-state');
  await steps.waitFor();
  assert.equal(await state('check'), 'now');
  await steps.getByRole('button', {name: 'Check the scanner'}).click();
  await page.locator('.finding').first().waitFor();
  await goTo(page, 'Scan');
  await steps.locator('[data-step=calibrate][data-state=now]').waitFor();
  await picture(page, 'first-steps');
  assert.deepEqual(await complaints(page), []);
  await steps.getByRole('link', {name: 'Calibrate'}).click();
  await page.getByRole('button', {name: 'Measure with a turn'}).click();
  await page.locator('#turn-outcome').waitFor();
  await goTo(page, 'Scan');
  await steps.locator('[data-step=scan][data-state=now]').waitFor();
  await scan(scanner, {...draft, snapshots: 4});
  await steps.waitFor({state: 'hidden'});
  assert.deepEqual(faults, []);
});

test('the first steps can be hidden for good', async (t) => {
  const scanner = await startScanner(t);
  const {page} = await openPage(await openBrowser(t), scanner.url);
  await page.getByRole('button', {name: 'Hide the first steps'}).click();
  await page.locator('#first-steps').waitFor({state: 'hidden'});
  const told = page.waitForResponse('**/api/v1/status');
  await page.reload();
  await told;
  await page.locator('[data-panel=form]').waitFor();
  assert.ok(await page.locator('#first-steps').isHidden());
});
