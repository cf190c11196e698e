// A scan on an emulated Raspberry Pi 3, with real software down to the hardware: Octurn's stepper on the chip's GPIO lines, whose
// pulses turn an emulated platform, and Octurn's Kinect driver on libusb and the kernel's USB, whose emulated Kinect sees
// that platform. The model is compared with the object.

import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {once} from 'node:events';
import {mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {basename} from 'node:path';
import {before, test} from 'node:test';

import {wakeUp} from '../wake_up.mjs';
import {TwinKinect} from './kinect.mjs';
import {writeScanFolder} from './scan_folder.mjs';
import {GpioObserver, stepsPerTurn, Turntable} from './turntable.mjs';

const {OCTURN_TWIN: folder, OCTURN_DEBIAN: debian, OCTURN_PROGRAMS: programs} = process.env;
const stops = 8;
const frameBytes = 2 * 640 * 480;
const pulsesInTurn = (stops - 1) * stepsPerTurn / stops;

/**
 * Boots the machine, takes turns of 8 stops, and ends. @param {number} turns @param {Turntable} turntable
 * @param {(kinect: TwinKinect) => Promise<void>} prepare  before the Kinect is plugged in
 * @returns {Promise<{said: string, frames: Buffer[][]}>} the console's output, and each turn's frames from the disk
 */
async function boot(turns, turntable, prepare) {
  const gpio = await GpioObserver.listen((line, level) => turntable.change(line, level), (seconds) => turntable.pass(seconds));
  const kinect = await TwinKinect.listen(async () => {
    await gpio.refresh();
    return turntable.angle;
  });
  writeFileSync(`${folder}/disk.img`, Buffer.alloc(turns * stops * frameBytes));
  const list = Array(turns).fill(stops).join(',');
  const qemu = spawn('qemu-system-aarch64', [
    '-M', 'raspi3b', '-nographic', '-no-reboot', '-monitor', 'none',
    '-icount', 'shift=1',  // the guest's clock counts instructions, half a billion a second, however busy this machine is
    '-serial', 'null', '-serial', `file:${folder}/console.log`,
    '-kernel', `${debian}/kernel`, '-dtb', `${debian}/pi3.dtb`, '-initrd', `${folder}/initrd.gz`,
    '-netdev', 'user,id=net', '-device', 'usb-net,netdev=net',
    '-drive', `if=none,id=disk,format=raw,file=${folder}/disk.img`, '-device', 'usb-storage,drive=disk',
    '-append', `console=ttyS1,115200 panic=-1 rdinit=/init quiet loglevel=3 kinect_port=${kinect.port} turns=${list}`,
    ...gpio.options,
  ], {stdio: 'ignore'});
  wakeUp(qemu);
  const end = () => qemu.kill('SIGKILL');
  process.once('exit', end);
  try {
    const ended = once(qemu, 'exit');
    await Promise.race([kinect.connected(), ended]);
    await prepare(kinect);
    await kinect.tell('plug');
    await ended;
  } finally {
    end();
    process.off('exit', end);
    await kinect.close();
    await gpio.close();
  }
  const bytes = readFileSync(`${folder}/disk.img`);
  const frame = (i) => bytes.subarray(i * frameBytes, (i + 1) * frameBytes);
  return {
    said: readFileSync(`${folder}/console.log`, 'latin1').replaceAll('\r', ''),
    frames: Array.from({length: turns}, (_, turn) => Array.from({length: stops}, (_, stop) => frame(turn * stops + stop))),
  };
}

/** Writes the frames of a turn as a scan. @returns {string} its folder */
function scanOf(frames, name) {
  const scan = `${folder}/${name}`;
  rmSync(scan, {recursive: true, force: true});
  mkdirSync(`${scan}/snapshots`, {recursive: true});
  writeScanFolder(scan, frames);
  return scan;
}

/** Lets Octurn make a model of a scan. @returns {{mean_mm: number, missing: number, quality: object}} its distance from the object,
 * and Octurn's own verdict */
function modelOf(scan) {
  const words = ['reconstruct', scan, '--method', 'solid', '--leaf-size-mm', '2', '-o', `${scan}.stl`, '--json'];
  const told = execFileSync(`${programs}/octurn`, words, {stdio: ['ignore', 'pipe', 'ignore']});
  const error = JSON.parse(execFileSync(`${programs}/twin_model_error`, [`${scan}.stl`]));
  const {quality} = JSON.parse(told);
  const reasons = quality.reasons.map(({code}) => code);
  console.log(`counted: model "${basename(scan)}": off by ${error.mean_mm.toFixed(2)} mm, 95 of 100 by ` +
    `${error.p95_mm.toFixed(2)}; missing ${(100 * error.missing).toFixed(0)} %; verdict ${[quality.verdict, ...reasons].join(', ')}`);
  return {...error, verdict: quality.verdict, reasons};
}

const turntable = new Turntable();
let turn;

before(async () => {
  turn = await boot(3, turntable, async (kinect) => {
    await kinect.tell('lose 3 100 5');  // every third frame loses packets
    turntable.atPulse(350, () => kinect.tell('unplug').then(() => kinect.tell('plug')));
    turntable.lose(20, pulsesInTurn + 350);  // in the second turn, on the way to stop 4
    turntable.atPulse(2 * pulsesInTurn, () => {
      turntable.isEnableStuck = true;  // in the third turn
    });
  });
  console.log(turn.said.trim());
});

test('each turn ends, with as many pulses as it is steps', () => {
  assert.match(turn.said, /FINISHED/);
  assert.doesNotMatch(turn.said, /ended with/);
  assert.equal(turntable.pulses, 3 * pulsesInTurn);
  assert.equal(turntable.position, 2 * pulsesInTurn - 20);
  // The platform has weight: lost steps would be a period of the coils, 7.2 degrees. In the third turn, its motor off, it coasts.
  const lag = 360 * turntable.position / stepsPerTurn - turntable.angle * 180 / Math.PI;
  assert.ok(Math.abs(lag) < 3.6, `the platform lags by ${lag} degrees`);
});

test('torn frames are told and not taken, and a Kinect whose plug was pulled is found again', () => {
  assert.ok(Number(/damaged frames ([0-9]+)/.exec(turn.said)[1]) > 0);
  assert.equal(turn.said.match(/Kinect lost/g).length, 1);
  assert.match(turn.said, /tilt told/);
});

test('the model is the object that stood on the platform', () => {
  const {mean_mm: mean, missing, verdict} = modelOf(scanOf(turn.frames[0], 'whole'));
  // The simulated rig scans the same object with as many stops to 0.44 to 0.47 mm.
  assert.ok(mean < 1 && missing < 0.1, `${mean} mm, ${missing} missing`);
  assert.equal(verdict, 'good');
});

test('pulses that the motor lost make another model, which is not called good', () => {
  const {mean_mm: mean, verdict} = modelOf(scanOf(turn.frames[1], 'lost'));
  assert.ok(mean > 3, `${mean} mm`);  // half of the stops are 9 degrees off
  assert.notEqual(verdict, 'good');
});

test('a platform that stands, since ENABLE is stuck, makes stops disagree', () => {
  const {verdict, reasons} = modelOf(scanOf(turn.frames[2], 'stuck'));
  assert.equal(verdict, 'bad');
  assert.ok(reasons.includes('stops-disagree'), reasons.join());
});
