// What goes wrong at a rig, in the appliance's twin: torn frames, the Kinect's plug, the Pi's plug, lost pulses, a stuck ENABLE.
// Faults come with pulses of the motor, so that they come at the same moment of the scan however slow the machine is.

import {require} from './checks.mjs';
import {stepsPerTurn} from '../emulation/twin/turntable.mjs';

const stops = 8;
const pulsesToStop = (stop) => stop * stepsPerTurn / stops;

const tornAtTimes = 'lose 3 100 5';  // of every third frame five packets
const tornAlways = 'lose 1 100 60';  // more than a fifth

const lostSteps = ({commanded, position}) => commanded - position;

const told = ({error}) => `${error.code}: ${error.detail}. ${error.hint}`;

/** Has something happen when the motor gets its pulse `number` of the scan to come. @returns {Promise<void>} when it does */
function atPulse({turntable}, number, action) {
  return new Promise((come, fail) => turntable.atPulse(turntable.pulses + number, () => action().then(come, fail)));
}

/** Waits until a scan that still runs says that it tries a stop again, for one of these reasons. */
const triesAgain = (twin, scan, stop, codes) => twin.reaches(scan, `stop ${stop} is tried again`, (now) => {
  require(now.state === 'running', `${scan} is ${now.state}: ${JSON.stringify(now.error)}`);
  return now.snapshots_done === stop && codes.includes(now.error?.code);
});

const hasTaken = (twin, scan, snapshots) => twin.reaches(scan, `${snapshots} snapshots`, (now) => now.snapshots_done >= snapshots);

/** Frames that are all torn are told of, and not taken; the scan goes on when there are whole ones again. */
async function testTornFrames(twin, scan, say) {
  say(`all frames torn at stop 1: tried again, ${told(await triesAgain(twin, scan, 1, ['sensor-silent']))}`);
  await twin.sensor.tell(tornAtTimes);
  await hasTaken(twin, scan, 2);
  say('two of three frames whole again: it goes on');
}

/** A plug that is put back soon: nobody has to do anything. */
async function testPlugPulled(twin, scan, say) {
  const gone = ['sensor-lost', 'sensor-missing', 'sensor-silent'];
  say(`the Kinect's plug pulled on the way to stop 2: tried again, ${told(await triesAgain(twin, scan, 2, gone))}`);
  await twin.sensor.tell('plug');
  await hasTaken(twin, scan, 3);
  say('the plug put back: it goes on');
}

/** A plug that stays out: the scan says so, switches the motor off, and waits for somebody. */
async function testPlugLeftOut(twin, scan, say) {
  const paused = await twin.reaches(scan, 'a pause', ({state}) => state === 'paused');
  require(paused.snapshots_done === 3 && paused.error.hint.includes('resume the scan'), JSON.stringify(paused.error));
  require(!twin.turntable.isOn, 'the scan is paused, and the motor is on');
  say(`the plug left out at stop 3: paused with 3 snapshots, the motor off, ${told(paused)}`);
  await twin.sensor.tell('plug');
  await twin.resume(scan);
  say('the plug put back: it is resumed');
}

/** The scan that all this happens to is the object in the end. */
async function testInterruptedScan(twin, say) {
  const {turntable, sensor: kinect} = twin;
  const first = turntable.position;
  await kinect.tell(tornAtTimes);
  const faults = [
    atPulse(twin, 50, () => kinect.tell(tornAlways)),
    atPulse(twin, 150, () => kinect.tell('unplug')),
    atPulse(twin, 250, () => kinect.tell('unplug')),
  ];
  // At stop 4, before its snapshot is taken.
  const cut = atPulse(twin, pulsesToStop(4), () => twin.cutPower());
  const scan = await twin.startScan({snapshots: stops, frames: 3, leaf_size_mm: 2});
  await testTornFrames(twin, scan, say);
  await testPlugPulled(twin, scan, say);
  await testPlugLeftOut(twin, scan, say);
  await Promise.all([...faults, cut]);
  say('power cut at stop 4');

  say(await twin.start());
  const {scans} = await twin.guest.ask('scans');
  const left = scans.find(({id}) => scan.endsWith(id));
  require(left?.state === 'interrupted' && left.snapshots_done === 4 && left.can_resume, `after the power cut: ${JSON.stringify(left)}`);
  await kinect.tell(tornAtTimes);
  await twin.resume(scan);
  say('it is listed as interrupted with 4 snapshots, and is resumed');
  const {model} = await twin.finishes(scan);
  require(turntable.position === first + stepsPerTurn, `the platform is at ${turntable.position}`);
  const {sent, damaged} = await kinect.frames();
  require(damaged > 0, 'no frame was torn');
  say(`its model, with ${damaged} of ${sent} frames torn since the start: ${await twin.checkModel(scan)}; the daemon's verdict: ` +
    model.quality.verdict);
  await kinect.tell('lose 1 0 0');
}

/** @returns {Promise<object>} a scan with coarse leaves, which is about its findings */
async function scanCoarsely(twin) {
  return twin.finishes(await twin.startScan({snapshots: stops, frames: 3, leaf_size_mm: 4}));
}

const findings = ({model, calibration}) => `verdict ${model.quality.verdict}; ` +
  [...model.quality.reasons, ...calibration.findings].map(({code, detail}) => `${code}: ${detail}`).join('; ');

/** A motor that loses steps on its way to stop 4: the scan's own checks say that the platform stood elsewhere. */
async function testLostPulses(twin, say) {
  const {turntable} = twin;
  const [lost, before] = [20, lostSteps(turntable)];
  turntable.lose(lost, pulsesToStop(3) + 30);
  const scan = await scanCoarsely(twin);
  require(lostSteps(turntable) === before + lost, `the motor has lost ${lostSteps(turntable) - before} steps`);
  say(`${lost} pulses lost on the way to stop 4: ${findings(scan)}`);
  const off = 360 * lost / stepsPerTurn;
  const isNamed = ({parameters: {turn_deg: turn, off_deg: slip}}) =>
    Math.abs(Math.abs(slip) - off) < 2 || Math.abs(turn - off) < 2 || Math.abs(360 - turn - off) < 2;
  require(scan.model.quality.verdict !== 'good' && [...scan.model.quality.reasons, ...scan.calibration.findings].some(isNamed),
    `nothing says that the platform was off by ${off} degrees`);
}

/** A driver that never switches the motor on: the scan says that the platform did not turn. */
async function testStuckEnable(twin, say) {
  const {turntable} = twin;
  const {position} = turntable;
  turntable.isEnableStuck = true;
  const scan = await scanCoarsely(twin);
  turntable.isEnableStuck = false;
  require(turntable.position === position, 'the platform has turned');
  const {accepted, reason} = scan.calibration;
  say(`ENABLE stuck: ${findings(scan)}; its pose: ${reason}`);
  require(!accepted && reason.includes('the platform did not turn') && scan.model.quality.verdict === 'bad',
    'nothing says that the platform stood still');
}

/** @param {import('./twin.mjs').Twin} twin  that runs @param {(text: string) => void} say */
export async function testFaults(twin, say) {
  await testInterruptedScan(twin, say);
  await testLostPulses(twin, say);
  await testStuckEnable(twin, say);
}
