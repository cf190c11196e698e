// The turntable of the appliance's twin: its motor driver is connected to the GPIO lines of the chip that QEMU emulates.

import {once} from 'node:events';
import {createServer} from 'node:net';
import {createInterface} from 'node:readline';

/** Octurn's default lines, as GPIO numbers. */
const lines = {step: 17, direction: 27, enable: 5};

/** Microsteps a turn: a 1.8 degree motor on the platform's shaft, in quarter steps. */
export const stepsPerTurn = 800;

const fullStepsPerTurn = 200;

/** Microsteps of the coils' electrical period, four full steps. At power-up the driver starts at the period's home position (A4988,
 * table 2). */
const stepsPerPeriod = 16;

/** The levels by the board's resistors while nothing drives the lines. */
const undriven = {[lines.step]: 0, [lines.direction]: 0, [lines.enable]: 1};

/**
 * A platform of some inertia on its motor's magnetic spring, as turntable/simulated_turntable.hpp has it: it lags behind
 * the field, swings, and loses whole periods where the torque T sin(50 (field - platform)) is too small. Angles in
 * radians.
 */
class LoadedPlatform {
  #load;
  #speed = 0;  // radians a second
  #owed = 0;   // seconds

  angle;

  constructor(load, angle) {
    this.#load = load;
    this.angle = angle;
  }

  /** @param {number} seconds @param {number | null} field angle of the coils' field; null: they have no current */
  advance(seconds, field) {
    const {holdingTorque, inertia, friction, damping} = this.#load;
    const step = 1e-4;
    for (this.#owed += seconds; this.#owed >= step; this.#owed -= step) {
      const pull = field === null ? 0 : holdingTorque * Math.sin(fullStepsPerTurn / 4 * (field - this.angle));
      const pushed = this.#speed + (pull - damping * this.#speed) / inertia * step;
      this.#speed = Math.sign(pushed) * Math.max(0, Math.abs(pushed) - friction / inertia * step);
      this.angle += this.#speed * step;
    }
  }
}

/** The documented parts: a NEMA 17 of 0.4 N m at half of its current, and 28 cm of 12 mm birch plywood. N m, kg m^2, N m, N m s. */
export const documentedLoad = {holdingTorque: 0.2, inertia: 0.005, friction: 0.02, damping: 1e-3};

/** An A4988, a motor, and the platform on it. */
export class Turntable {
  #levels = {...undriven};
  #toLose = [];
  #lossPeriod = Infinity;
  #isAtHome = false;  // whether the driver is at its home position, since power-up
  #actions = new Map();
  #platform;

  /** The platform's position, microsteps, counter-clockwise. */
  position = 0;

  /** The position if no step had been lost, microsteps. */
  commanded = 0;

  /** Rising edges of STEP so far. */
  pulses = 0;

  /** Whether the driver's ENABLE is disconnected, so that its pull-up keeps the motor off. */
  isEnableStuck = false;

  /** @param {typeof documentedLoad | null} load  the platform's inertia, and what moves it; null: it follows each pulse at once */
  constructor(load = documentedLoad) {
    this.#platform = load && new LoadedPlatform(load, 0);
  }

  get isOn() {
    return this.#levels[lines.enable] === 0 && !this.isEnableStuck;
  }

  /** Radians, counter-clockwise seen from above. */
  get angle() {
    return this.#platform?.angle ?? this.#field;
  }

  get #field() {
    return 2 * Math.PI * this.position / stepsPerTurn;
  }

  /** Lets time pass. @param {number} seconds */
  pass(seconds) {
    this.#platform?.advance(seconds, this.isOn ? this.#field : null);
  }

  /** The angle if no step had been lost, radians. */
  get commandedAngle() {
    return 2 * Math.PI * this.commanded / stepsPerTurn;
  }

  /** Lets the motor miss `count` pulses, after `after` more pulses. */
  lose(count, after = 0) {
    this.#toLose = Array.from({length: count}, (_, i) => this.pulses + after + i + 1);
  }

  /** Lets the motor miss every `period`-th pulse from now on, as one too weak for its load does; Infinity: none. */
  loseEach(period) {
    this.#lossPeriod = period;
  }

  /** Cuts and restores power: the lines are undriven, and when the motor is enabled next, it jumps to the nearest home position of
   * the driver. */
  losePower() {
    this.#levels = {...undriven};
    this.#isAtHome = true;
  }

  /** Calls `action` after pulse `number`, for example in the middle of a move. */
  atPulse(number, action) {
    this.#actions.set(number, action);
  }

  /** Handles the change of a GPIO line. @param {number} line @param {0 | 1} level */
  change(line, level) {
    const rises = level === 1 && this.#levels[line] === 0;
    this.#levels[line] = level;
    if (this.isOn && this.#isAtHome) {
      this.position = stepsPerPeriod * Math.round(this.position / stepsPerPeriod);
      this.#isAtHome = false;
    }
    if (line !== lines.step || !rises) {
      return;
    }
    const step = this.#levels[lines.direction] === 1 ? 1 : -1;
    const isLost = this.#toLose.includes(++this.pulses) || this.pulses % this.#lossPeriod === 0;
    this.commanded += step;
    this.position += this.isOn && !isLost ? step : 0;
    this.#actions.get(this.pulses)?.();
  }
}

/** The GPIO block of QEMU's Raspberry Pi 3: its QOM path, and its registers (BCM2835 peripherals, 6.1). */
const block = '/machine/soc/peripherals/gpio';
const registers = 0x3f200000;
const set = registers + 0x1c;
const functions = (line) => registers + 4 * Math.floor(line / 10);
const output = (line) => 1 << (3 * (line % 10));

/** The chip's free running counter of microseconds, its lower half (12.1). It goes by the guest's clock. */
const counter = 0x3f003004;
const refreshInterval = 5;  // ms

/**
 * Observes the chip's GPIO lines by QEMU's qtest protocol, which reports each change of an output, and its clock. In QEMU a line that
 * becomes an input keeps its level, although a resistor would pull it.
 */
export class GpioObserver {
  #server;
  #socket;
  #pass;
  #ticks;         // of the counter, when it was read last
  #answered = [];  // what waits for the answers to come, in order

  /** @param {(line: number, level: 0 | 1) => void} change @param {(seconds: number) => void} pass  told of the guest's time */
  static async listen(change, pass = () => {}) {
    const observer = new GpioObserver();
    observer.#pass = pass;
    observer.#server = createServer((socket) => observer.#watch(socket, change)).listen(0, '127.0.0.1');
    await once(observer.#server, 'listening');
    return observer;
  }

  /** Options for QEMU. */
  get options() {
    return ['-qtest', `tcp:127.0.0.1:${this.#server.address().port}`, '-qtest-log', 'none'];
  }

  /** Writes a register like the chip's processor. */
  write(register, value) {
    this.#ask(`writel 0x${register.toString(16)} 0x${value.toString(16)}`);
  }

  /**
   * Waits until all that the guest did before has been handled, by reading its clock twice. The first answer comes after the reports of
   * what it did, each of which asks for its own time; the second answer comes after those times.
   */
  async refresh() {
    for (let time = 0; time < 2 && this.#socket; ++time) {
      await new Promise((come) => this.#readClock(come));
    }
  }

  async close() {
    this.#socket?.destroy();
    this.#server.close();
    await once(this.#server, 'close');
  }

  #ask(command, answered = () => {}) {
    this.#answered.push(answered);
    this.#socket.write(`${command}\n`);
  }

  #readClock(then) {
    this.#ask(`readl 0x${counter.toString(16)}`, (text) => {
      if (text) {
        const ticks = Number(text);
        this.#pass((ticks - (this.#ticks ?? ticks) >>> 0) / 1e6);
        this.#ticks = ticks;
      }
      then();
    });
  }

  #watch(socket, change) {
    this.#socket = socket;
    this.#ticks = undefined;  // each guest's clock begins anew
    const timer = setInterval(() => this.#readClock(() => {}), refreshInterval);
    const reports = createInterface({input: socket});
    [socket, reports].forEach((stream) => stream.on('error', () => {}));  // QEMU is killed when power is cut
    socket.on('close', () => {
      clearInterval(timer);
      this.#socket = undefined;
      this.#answered.splice(0).forEach((answered) => answered(''));  // QEMU has ended
    });
    reports.on('line', (text) => {
      const [, level, line] = /^IRQ (raise|lower) ([0-9]+)$/.exec(text) ?? [];
      if (level) {
        this.#readClock(() => change(Number(line), level === 'raise' ? 1 : 0));
      } else {
        this.#answered.shift()?.(text.replace(/^OK ?/, ''));
      }
    });
    this.#ask(`irq_intercept_out ${block}`);
    // On a Pi, GPIO0 to 8 are pulled up at boot, ENABLE among them. QEMU's chip has no resistors, so it is driven high here.
    this.write(functions(lines.enable), output(lines.enable));
    this.write(set, 1 << lines.enable);
    this.write(functions(lines.enable), 0);
  }
}
