// The twin's turntable: alone, and on the GPIO block of QEMU's Raspberry Pi 3, whose registers this test writes.

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {test} from 'node:test';

import {documentedLoad, GpioObserver, Turntable} from './turntable.mjs';

const step = 17;
const direction = 27;
const enable = 5;

const pulse = (turntable) => {
  turntable.change(step, 1);
  turntable.change(step, 0);
};
const steps = (turntable, count) => Array.from({length: count}).forEach(() => pulse(turntable));

test('the platform turns by a microstep with each rising edge, in the direction of DIR', () => {
  const turntable = new Turntable(null);
  turntable.change(enable, 0);
  turntable.change(direction, 1);
  steps(turntable, 200);
  assert.equal(turntable.angle, Math.PI / 2);
  turntable.change(direction, 0);
  steps(turntable, 300);
  assert.equal(turntable.position, -100);
  assert.equal(turntable.pulses, 500);
});

test('it stands while ENABLE is high, as it is until somebody drives it, and while it is stuck', () => {
  const turntable = new Turntable(null);
  turntable.change(direction, 1);
  steps(turntable, 5);
  assert.equal(turntable.position, 0);
  turntable.change(enable, 0);
  turntable.isEnableStuck = true;
  steps(turntable, 5);
  assert.equal(turntable.position, 0);
  turntable.isEnableStuck = false;
  steps(turntable, 5);
  assert.equal(turntable.position, 5);
});

test('the motor misses the pulses that it is told to', () => {
  const turntable = new Turntable(null);
  turntable.change(enable, 0);
  turntable.change(direction, 1);
  turntable.lose(3, 10);
  steps(turntable, 10);
  assert.equal(turntable.position, 10);
  steps(turntable, 10);
  assert.equal(turntable.position, 17);
});

test('it knows where it was told to be, and where it is', () => {
  const turntable = new Turntable(null);
  turntable.change(enable, 0);
  turntable.change(direction, 1);
  turntable.lose(20);
  steps(turntable, 400);
  assert.equal(turntable.commandedAngle, Math.PI);
  assert.equal(turntable.commanded - turntable.position, 20);
  turntable.isEnableStuck = true;
  steps(turntable, 100);
  assert.deepEqual([turntable.commanded, turntable.position], [500, 380]);
});

test('a weak motor misses a share of the pulses', () => {
  const turntable = new Turntable(null);
  turntable.change(enable, 0);
  turntable.change(direction, 1);
  turntable.loseEach(25);
  steps(turntable, 800);
  assert.equal(turntable.position, 800 - 32);
  turntable.loseEach(Infinity);
  steps(turntable, 100);
  assert.equal(turntable.position, 900 - 32);
});

test('after a cut of power the lines are undriven, and the motor jumps to where its driver begins once it is on', () => {
  const turntable = new Turntable(null);
  turntable.change(enable, 0);
  turntable.change(direction, 1);
  steps(turntable, 99);
  turntable.change(step, 1);
  assert.equal(turntable.position, 100);
  turntable.losePower();
  assert.equal(turntable.isOn, false);
  assert.equal(turntable.position, 100);
  turntable.change(enable, 0);
  assert.equal(turntable.position, 96);
  turntable.change(direction, 1);
  steps(turntable, 4);  // including the first, although STEP was high before
  assert.equal(turntable.position, 100);
  turntable.change(enable, 1);
  turntable.change(enable, 0);
  assert.equal(turntable.position, 100);
});

test('something happens with a pulse, after the platform has made its step', () => {
  const turntable = new Turntable(null);
  turntable.change(enable, 0);
  turntable.change(direction, 1);
  let seen;
  turntable.atPulse(3, () => {
    seen = turntable.position;
  });
  steps(turntable, 5);
  assert.equal(seen, 3);
});

test('QEMU tells each change of the lines that are outputs', async () => {
  const changes = [];
  const observer = await GpioObserver.listen((line, level) => changes.push([line, level]));
  // -S stops the processor, so that nothing else writes to the registers.
  const qemu = spawn('qemu-system-aarch64', ['-M', 'raspi3b', '-S', '-display', 'none', '-monitor', 'none', ...observer.options],
    {stdio: 'ignore'});
  const until = async (count) => {
    while (changes.length < count) {
      assert.equal(qemu.exitCode, null);
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
  };
  try {
    await until(1);  // ENABLE goes high
    const [functions1, functions2, set, clear] = [0x3f200004, 0x3f200008, 0x3f20001c, 0x3f200028];
    observer.write(functions1, 1 << 21);  // GPIO17 is an output
    observer.write(set, 1 << step | 1 << direction);
    observer.write(clear, 1 << step | 1 << direction);
    observer.write(functions2, 1 << 21);  // and GPIO27
    observer.write(set, 1 << direction);
    observer.write(set, 1 << step);
    await observer.refresh();
    assert.deepEqual(changes, [[enable, 1], [step, 1], [step, 0], [direction, 1], [step, 1]]);
  } finally {
    qemu.kill('SIGKILL');
    await once(qemu, 'exit');
    await observer.close();
  }
});

/** Makes the pulses of a move at the angles' pace: from and to `start` steps a second, `ramp` steps a second gained each second. */
const turnBy = (turntable, {start, top, ramp}, steps) => {
  turntable.change(5, 0);
  turntable.change(27, 1);
  let speed = start;
  for (let left = steps; left > 0; --left) {
    speed = Math.min(Math.sqrt(speed ** 2 + 2 * ramp), top, Math.sqrt(start ** 2 + 2 * ramp * left));
    turntable.pass(1 / speed);
    turntable.change(17, 1);
    turntable.change(17, 0);
  }
  turntable.pass(3);
};

test('a platform with inertia follows gentle speeds, and loses a period by quick ones', () => {
  const moved = (speeds) => {
    const turntable = new Turntable();
    turnBy(turntable, speeds, 22);
    return turntable.angle * 180 / Math.PI;
  };
  assert.ok(Math.abs(moved({start: 40, top: 200, ramp: 150}) - 9.9) < 0.2);
  const quick = moved({start: 200, top: 800, ramp: 2000});
  assert.ok(Math.abs(quick - 9.9) > 7, `moved by ${quick} degrees`);
});

test('a heavy platform swings after its last pulse', () => {
  const turntable = new Turntable({...documentedLoad, friction: 0});
  turnBy(turntable, {start: 40, top: 200, ramp: 150}, 4);
  const angles = Array.from({length: 30}, () => {
    turntable.pass(0.01);
    return turntable.angle;
  });
  assert.ok(Math.max(...angles) - Math.min(...angles) > 0.001);
});
