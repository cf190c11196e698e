// The GPIO lines of the emulated Pi, as its kernel traced them and as QEMU logged register writes.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

import { GpioRegisters } from './registers.mjs';

const folder = process.env.OCTURN_PI3;
const base = 512; // number of the first GPIO line in Debian 13's kernel
const step = 17;
const direction = 27;
const enable = 5;
const lines = [enable, step, 22, 23, 24, direction];

const consoleText = readFileSync(`${folder}/console.log`, 'latin1').replaceAll('\r', '');

/** One run of stepper_check: its output, and the kernel's trace events: {time, line, level} or {time, mark}. */
function run(name) {
  const all = consoleText.split(`BEGIN ${name}\n`)[1].split(`END ${name}\n`)[0].trim().split('\n');
  const said = [];
  const events = [];
  for (const text of all) {
    const [, time, line, level] = /^([0-9.]+) ([0-9]+) ([01])$/.exec(text) ?? [];
    const [, markTime, mark] = /^([0-9.]+) ([A-Z]+)$/.exec(text) ?? [];
    if (time) events.push({ time: Number(time), line: Number(line) - base, level: Number(level) });
    else if (mark) events.push({ time: Number(markTime), mark });
    else said.push(text);
  }
  return { said: said.join('\n'), events };
}

const names = ['turn', 'turns', 'cancel', 'kill', 'busy', 'burdened'];
const runs = Object.fromEntries(names.map((name) => [name, run(name)]));

const rises = (events) => events.filter(({ line, level }) => line === step && level === 1);
const levels = (events, wanted) => events.filter(({ line }) => line === wanted).map(({ level }) => level).join('');

test("the kernel lets the image's watchdog wait longer than the chip can", () => {
  const settings = readFileSync(`${import.meta.dirname}/../../../image-build/root/etc/systemd/system.conf.d/octurn.conf`, 'utf8');
  const wanted = Number(/^RuntimeWatchdogSec=([0-9]+)$/m.exec(settings)[1]);
  const limit = Number(/WATCHDOG at most ([0-9]+) s/.exec(consoleText)[1]); // 0: none
  assert.ok(wanted > 16 && (limit === 0 || wanted <= limit), `${wanted} s of ${limit}`);
});

test('a turn is 800 pulses', () => {
  assert.match(runs.turn.said, /arrived at 800/);
  assert.equal(rises(runs.turn.events).length, 800);
});

test('there, back, and two turns of it are as many pulses as it is steps', () => {
  assert.match(runs.turns.said, /arrived at 1600/);
  const byDirection = { 0: 0, 1: 0 };
  let now = 0;
  for (const { line, level } of runs.turns.events) {
    if (line === direction) now = level;
    if (line === step && level === 1) byDirection[now] += 1;
  }
  assert.deepEqual(byDirection, { 1: 800 + 214 + 686, 0: 100 });
});

test('the motor is on, and its direction set, before the first pulse, and it is off after the last', () => {
  const { events } = runs.turn;
  const [first] = rises(events);
  const last = rises(events).at(-1);
  const on = events.find(({ line, level }) => line === enable && level === 0);
  const off = events.filter(({ line, level }) => line === enable && level === 1).at(-1);
  const chosen = events.filter(({ line }) => line === direction).at(-1);
  assert.ok(on.time < first.time && off.time > last.time);
  assert.ok(first.time - chosen.time > 200e-9); // the A4988's set-up time
  assert.equal(chosen.level, 1);
  assert.equal(levels(events, enable), '101'); // off as soon as the line is driven
  assert.equal([22, 23, 24].map((line) => levels(events, line)).join(''), '010'); // quarter-step mode
});

test('each level lasts 1 us or more', () => {
  for (const { events } of Object.values(runs)) {
    const changes = events.filter(({ line }) => line === step);
    for (let i = 1; i < changes.length; ++i) {
      assert.ok(changes[i].time - changes[i - 1].time >= 1e-6, `at ${changes[i].time}`);
    }
  }
});

test('pulses are never nearer to each other than at full speed, however late the one before was', () => {
  const { said, events } = runs.burdened;
  assert.match(said, /no real-time priority/);
  assert.ok(Number(/late pulses: ([0-9]+)/.exec(said)[1]) > 0, said);
  for (const run of Object.values(runs)) {
    const pulses = rises(run.events);
    for (let i = 1; i < pulses.length; ++i) {
      const gap = pulses[i].time - pulses[i - 1].time;
      assert.ok(gap >= 1 / 200 - 2e-6, `${gap} s at ${pulses[i].time}`); // the trace has whole microseconds
    }
  }
  assert.equal(rises(events).length, 800);
});

test('a stop request brakes the motor to the speed at which it starts, and the position is known', () => {
  const { said, events } = runs.cancel;
  const stopped = Number(/stopped at ([0-9]+)/.exec(said)[1]);
  const asked = events.findIndex(({ mark }) => mark === 'STOP');
  assert.ok(stopped > 0 && stopped < 800);
  assert.equal(rises(events).length, stopped);
  assert.ok(asked > 0);
  // From 200 to 40 steps/s at 150 steps/s^2: 128 steps, and the one that was due.
  assert.ok(rises(events.slice(asked)).length <= 129);
  const [before, last] = rises(events).slice(-2);
  assert.ok(last.time - before.time >= 1 / 44, `${last.time - before.time} s`);
  assert.equal(levels(events, enable), '101');
});

test('lines that somebody else has are refused by name', () => {
  assert.match(runs.busy.said, /turntable-failed: line GPIO17 is in use by octurn/);
  assert.equal(rises(runs.busy.events).length, 1600);
});

/** Register writes to our GPIO lines: {line, level}, or {line, input}. */
function registerWrites() {
  const registers = new GpioRegisters(lines);
  return readFileSync(`${folder}/registers.log`, 'latin1').trim().split('\n').flatMap((text) => registers.take(text));
}

test('the registers were written as the kernel says, change for change', () => {
  const seen = registerWrites().filter(({ level }) => level !== undefined);
  const told = names.flatMap((name) => runs[name].events)
    .filter(({ line }) => lines.includes(line)).map(({ line, level }) => ({ line, level }));
  assert.ok(told.length > 2 * (800 + 1800 + 1600 + 800));
  assert.deepEqual(seen, told);
});

test('a program that is killed leaves the motor off: its lines are inputs, which resistors pull', () => {
  const { events } = runs.kill;
  assert.equal(levels(events, enable), '10'); // the killed program could not switch the motor off
  assert.ok(rises(events).length < 800);
  const released = registerWrites().filter(({ input }) => input);
  assert.equal(released.filter(({ line }) => line === enable).length, names.length); // at the end of each run
});
