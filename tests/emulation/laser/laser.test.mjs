// The lasers of a scan on an emulated Raspberry Pi 3. Octurn's rig reads its camera through libcamera and the kernel's uvcvideo and
// drives lasers and motor by the chip's GPIO lines. The test's camera shows the lasers that these lines switch on.

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {createInterface} from 'node:readline';
import {before, test} from 'node:test';

import {UvcCamera} from '../camera/uvc_camera.mjs';
import {GpioRegisters, traceOptions} from '../pi3/registers.mjs';
import {wakeUp} from '../wake_up.mjs';

const {OCTURN_LASER: folder, OCTURN_DEBIAN: debian} = process.env;
const lens = {width: 320, height: 240, picturesPerSecond: 1};
const columns = new Map([[23, 100], [24, 220]]);  // picture column of each laser's line, by GPIO line
const [left, right] = columns.keys();
const step = 17;
const base = 512;  // number of the first GPIO line in Debian 13's kernel
const names = ['turn', 'cancel', 'kill', 'crash', 'silent', 'lost'];

/** Boots the machine and runs it to its end. @returns {Promise<{said: string[], writes: object[]}>} console lines, and register writes */
async function boot() {
  const lit = new Set();
  const said = [];
  const writes = [];
  let run;
  const camera = await UvcCamera.listen(lens, () => {
    const grey = new Uint8Array(lens.width * lens.height).fill(20);
    for (const line of lit) {
      for (let at = columns.get(line); at < grey.length; at += lens.width) {
        grey[at] = 200;
      }
    }
    return grey;
  });
  const qemu = spawn('qemu-system-aarch64', [
    '-M', 'raspi3b', '-nographic', '-no-reboot', '-monitor', 'none',
    '-icount', 'shift=1',  // the guest's clock counts instructions, half a billion a second, however busy this machine is
    '-serial', 'null', '-serial', 'stdio', ...traceOptions, ...camera.options,
    '-kernel', `${debian}/kernel`, '-dtb', `${debian}/pi3.dtb`, '-initrd', `${folder}/initrd.gz`,
    '-append', 'console=ttyS1,115200 panic=-1 rdinit=/init quiet loglevel=3'], {stdio: ['ignore', 'pipe', 'pipe']});
  wakeUp(qemu);
  const end = () => qemu.kill('SIGKILL');
  process.once('exit', end);
  const registers = new GpioRegisters([left, right, step]);
  createInterface({input: qemu.stderr}).on('line', (text) => {
    for (const write of registers.take(text)) {
      writes.push(write);
      if (write.level === 1 && columns.has(write.line)) {
        lit.add(write.line);
        camera.isSilent = run === 'silent';
        if (run === 'lost') {
          camera.unplug();
        }
      } else {
        lit.delete(write.line);  // an input is pulled down by its resistor
      }
    }
  });
  createInterface({input: qemu.stdout}).on('line', (text) => {
    const line = text.replaceAll('\r', '');
    said.push(line);
    run = /^BEGIN (.*)/.exec(line)?.[1] ?? run;
    if (line === 'END silent') {
      camera.isSilent = false;
    }
  });
  try {
    await once(qemu, 'close');
  } finally {
    end();
    process.off('exit', end);
    await camera.close();
  }
  return {said, writes};
}

/** A run of the check: its output, and the events of the kernel's trace: {time, line, level}, {time, released}, {time, signal}, {time, mark}. */
function runOf(said, name) {
  const run = {said: [], events: []};
  for (const text of said.slice(said.indexOf(`BEGIN ${name}`) + 1, said.indexOf(`END ${name}`))) {
    const [, time, kind, what, level] = /^([0-9.]+) (line|released|signal|mark) (\S+) ?([01])?$/.exec(text) ?? [];
    if (kind === 'line') {
      run.events.push({time: Number(time), line: Number(what) - base, level: Number(level)});
    } else if (kind) {
      run.events.push({time: Number(time), [kind]: kind === 'mark' ? what : Number(what)});
    } else if (text.startsWith('check: ')) {
      run.said.push(text.slice('check: '.length));
    }
  }
  return run;
}

/** The intervals in which a laser is on: {line, from, to, within: marks and signals in the interval}. */
function lightsIn({events}) {
  const lights = [];
  const on = new Map();
  for (const event of events) {
    const off = event.level === 0 ? event.line : event.released;
    if (event.level === 1 && columns.has(event.line)) {
      on.set(event.line, {line: event.line, from: event.time, within: []});
    } else if (on.has(off)) {
      lights.push({...on.get(off), to: event.time});
      on.delete(off);
    } else {
      on.forEach(({within}) => within.push(event));
    }
  }
  assert.equal(on.size, 0, 'a laser is on at the end');
  return lights;
}

const inMs = (seconds) => `${(1000 * seconds).toFixed(3)} ms`;
let runs;
let writes;

before(async () => {
  const booted = await boot();
  writes = booted.writes;
  console.log(booted.said.filter((text) => !/^[0-9.]+ (line|mark|signal|released)/.test(text)).join('\n'));
  assert.ok(booted.said.includes('FINISHED'));
  runs = Object.fromEntries(names.map((name) => [name, runOf(booted.said, name)]));
});

test('each laser is on for its own picture alone, and off while the platform turns, at idle and at the end', () => {
  const {said, events} = runs.turn;
  assert.deepEqual(said, [...[0, 200, 400, 600].map((at) => `at ${at}: dark 100 220`), 'idle']);
  const lights = lightsIn(runs.turn);
  assert.deepEqual(lights.map(({line}) => line), Array(4).fill([left, right]).flat());
  for (const {within} of lights) {
    assert.deepEqual(within.map(({mark}) => mark), ['PICTURE']);
  }
  assert.equal(events.filter(({mark}) => mark === 'PICTURE').length, 12);
  assert.ok(events.some(({line}) => line === step));
});

test('a cancel, a camera that is silent and one whose plug is pulled switch the laser off', () => {
  for (const [name, words] of [['cancel', /^stopped/], ['silent', /^sensor-silent/], ['lost', /^sensor-lost/]]) {
    const {said, events} = runs[name];
    assert.match(said[0], words);
    const lights = lightsIn(runs[name]);
    assert.equal(lights.length, 1, name);
    assert.equal(lights[0].line, left);
    assert.ok(events.some(({mark, time}) => ['STOPPED', 'FAILED'].includes(mark) && time >= lights[0].to), name);
  }
});

test('after kill -9 the laser is off within 10 ms of its machine\'s own time, and a crash waits for no core dump', () => {
  // A core dump would take a second. QEMU runs its four processors in turn, while the clock goes on for all: 4 to 11 ms were measured.
  for (const [name, number, limit] of [['kill', 9, 0.010], ['crash', 11, 0.1]]) {
    const {time: sent} = runs[name].events.find(({signal}) => signal === number);
    const released = runs[name].events.filter((event) => columns.has(event.released) && event.time >= sent);
    assert.deepEqual(released.map((event) => event.released), [left, right]);
    assert.equal(lightsIn(runs[name]).length, 1);
    const after = released[0].time - sent;
    console.log(`counted: ${name}: the laser is off after ${inMs(after)}`);
    assert.ok(after < limit, `${name}: ${inMs(after)}`);
  }
});

test('the registers were written as the kernel says, change for change, and a released line is an input', () => {
  const lines = [left, right, step];
  const told = names.flatMap((name) => runs[name].events).filter(({line, released}) => lines.includes(line ?? released))
    .map(({line, released, level}) => released === undefined ? {line, level} : {line: released, input: true});
  assert.ok(told.length > 2 * 600);
  assert.deepEqual(writes, told);
});
