// A scan by laser line in the appliance's twin: a camera on the guest's USB, below its kernel's uvcvideo and its libcamera, sees what
// the stepper's pulses turn and what the GPIO lines of the lasers light. In the middle the camera's plug is pulled, and put in again.
// Arguments: the folder of the card, and the folder with the tests' programs.

import {readFile} from 'node:fs/promises';

import {require, runTest, until} from './checks.mjs';
import {secondsSince} from './guest.mjs';
import {teller, Twin} from './twin.mjs';
import {TwinLaserCamera} from '../emulation/twin/laser_camera.mjs';
import {stepsPerTurn} from '../emulation/twin/turntable.mjs';

const [card, made] = process.argv.slice(2);
const stops = 60;
const lastPosition = Math.round(stepsPerTurn * (stops - 1) / stops);
const say = teller('laser twin');

// Of the emulated machine, which is given as long for a picture as it took to receive the one before.
const picturesPerSecond = 4;

// The simulated rig, with as many stops and such pictures: 0.81, 0.27 and 3.6 mm, and 0.17. Camera and lasers do not see below chin,
// arms and body, where the model is closed over what it lacks. With angles that are a stop late it is 1.4, 0.96 and 4.4 mm.
const limits = {mean_mm: 1.2, median_mm: 0.6, p95_mm: 5, missing: 0.25};

/** The camera's lens, which is as octurn.txt tells it. */
async function toldLens() {
  const text = await readFile(`${card}/octurn.txt`, 'utf8');
  return Object.fromEntries([...text.matchAll(/^laser\.(\w+) = ([0-9.]+)$/gm)].map(([, key, value]) => [key, Number(value)]));
}

/** The doctor, before a scan: camera and lasers are there, and the camera sees each laser. */
async function testDoctor({guest}) {
  const {findings} = await until('the doctor', () => guest.ask('doctor').catch(() => undefined));
  const {state, measured} = findings.find(({check}) => check === 'sensor');
  require(state === 'ok' && measured.endsWith('sees laser left and right'), `the doctor finds of the sensor: ${state}, ${measured}`);
  say(`octurn doctor: ${measured}`);
}

/** Has the camera's plug be pulled in the middle of a move. @returns {Promise<void>} when it is out */
const unplugAtPulse = ({turntable, sensor}, number) => new Promise((come) => turntable.atPulse(number, () => come(sensor.unplug())));

/** Puts the camera's plug in again, once the scan has missed it: nobody has to do anything else. */
async function testPlug(twin, scan, unplugged) {
  const lost = await twin.reaches(scan, 'the camera is missed', ({error}) => error?.code.startsWith('sensor-'));
  const {lit} = twin.sensor.lasers;
  require(lost.state === 'running' && lit === 'none', `without its camera the scan is ${lost.state}, and ${lit} is lit`);
  say(`the camera's plug pulled after ${lost.snapshots_done} of ${stops} stops: tried again, ${lost.error.code}: ${lost.error.detail}`);
  await unplugged;
  twin.sensor.plug();
  await twin.reaches(scan, 'another stop', (now) => now.snapshots_done > lost.snapshots_done);
  say('the plug put in: it goes on');
}

async function testScan(twin) {
  const {turntable, sensor: {lasers, pictures}} = twin;
  const before = {...pictures};
  const unplugged = unplugAtPulse(twin, Math.round(stepsPerTurn / 2 - stepsPerTurn / stops / 2));
  const scan = await twin.startScan({snapshots: stops, leaf_size_mm: 1});
  const begin = performance.now();
  await testPlug(twin, scan, unplugged);
  const done = await twin.finishes(scan);
  const shown = Object.entries(pictures).map(([lit, count]) => `${count - before[lit]} with ${lit}`).join(', ');
  say(`a scan of ${stops} stops in ${secondsSince(begin).toFixed(1)} s, ${done.seconds_elapsed.toFixed(1)} s by the scanner's clock: ` +
    `pictures ${shown}; ${done.late_pulses} of ${turntable.pulses} pulses late; the daemon's verdict: ${done.model.quality.verdict}`);
  say(`its model: ${await twin.checkModel(scan, limits)}`);
  const {pulses, position} = turntable;
  require(pulses === lastPosition && position === lastPosition, `at the end of ${pulses} pulses the platform is at ${position}`);
  require(lasers.lights.left >= stops && lasers.lights.right >= stops, `lasers were switched on ${JSON.stringify(lasers.lights)} times`);
}

const lens = await toldLens();
const twin = await Twin.make(card, made,
  (angle) => TwinLaserCamera.listen(`${made}/laser_camera`, {...lens, picturesPerSecond}, angle));
await runTest('laser twin', () => twin.guest, async () => {
  say(await twin.start());
  await testDoctor(twin);
  await testScan(twin);
  const {faults, lights, lit} = twin.sensor.lasers;
  require(faults.length === 0 && lit === 'none' && !twin.turntable.isOn, `${faults.join('; ')}; at the end ${lit} is lit`);
  say(`lasers were switched on ${lights.left} and ${lights.right} times, never while the platform made a step, and both are off`);
  say(`${(await twin.guest.processorSeconds()).toFixed(0)} s of processor time`);
});
await twin.close();
