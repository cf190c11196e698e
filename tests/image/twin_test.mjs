// A scan in the appliance's twin without faults, and then with them. Arguments: the folder of the card, the folder that
// tests/emulation/twin/make has made, how many percent of its Kinect's packets are lost, and `faults`, if these are asked for.

import {require, runTest} from './checks.mjs';
import {secondsSince} from './guest.mjs';
import {teller, Twin} from './twin.mjs';
import {testFaults} from './twin_faults.mjs';
import {GuestKinect} from './twin_kinect.mjs';
import {stepsPerTurn} from '../emulation/twin/turntable.mjs';

const [card, made, loss, faults] = process.argv.slice(2);
const stops = 8;
const say = teller('twin');

const lateOf = ({late_pulses: late}) => `${late} of ${stepsPerTurn} pulses late`;

/** What the packets in flight bridged. @returns {Promise<string>} */
async function delaysOf(twin) {
  const {count, half, most, longest} = await twin.sensor.delays();
  const ms = (time) => `${time.toFixed(1)} ms`;
  return `${count} transfers submitted again after at most ${ms(half)} (half), ${ms(most)} (99 of 100) and ${ms(longest)} (all)`;
}

/** @returns {Promise<string>} the scan's path */
async function testScan(twin) {
  const scan = await twin.startScan({snapshots: stops, frames: 3, leaf_size_mm: 2});
  const begin = performance.now();
  const done = await twin.finishes(scan);
  const seconds = secondsSince(begin);
  const {sent, damaged} = await twin.sensor.frames();
  const {pulses, position} = twin.turntable;
  say(`a scan of ${stops} snapshots in ${seconds.toFixed(1)} s, ${done.seconds_elapsed.toFixed(1)} s by the scanner's clock: ` +
    `${lateOf(done)}, ${sent} frames, ${damaged} of them damaged; the daemon's verdict: ${done.model.quality.verdict}`);
  require(pulses === stepsPerTurn && position === stepsPerTurn, `after a turn of ${stepsPerTurn} steps the platform is at ${position}`);
  say(await delaysOf(twin));
  say(`its model: ${await twin.checkModel(scan)}`);
  return scan;
}

/** A scan while two clients download a model again and again: late pulses lose no step. */
async function testBusyScan(twin, model) {
  const {position} = twin.turntable;
  const scan = await twin.startScan({snapshots: stops, frames: 3, leaf_size_mm: 4});
  let goesOn = true;
  let downloads = 0;
  const download = async () => {
    for (; goesOn; ++downloads) {
      await twin.download(model);
    }
  };
  const [done] = await Promise.all([twin.finishes(scan).finally(() => {
    goesOn = false;
  }), download(), download()]);
  say(`a scan while a model was downloaded ${downloads} times: ${lateOf(done)}; ${await delaysOf(twin)}`);
  require(downloads > 0 && twin.turntable.position === position + stepsPerTurn, `the platform is at ${twin.turntable.position}`);
}

const twin = await Twin.make(card, made, (angle) => GuestKinect.make(made, angle));
await runTest('twin', () => twin.guest, async () => {
  say(await twin.start());
  await twin.sensor.tell(`drop ${loss / 100}`);
  await testBusyScan(twin, await testScan(twin));
  if (faults === 'faults') {
    await testFaults(twin, say);
  }
  say(`${(await twin.guest.processorSeconds()).toFixed(0)} s of processor time since the last start`);
});
await twin.close();
