// The turntable of the appliance's twin: its motor's driver hangs on the GPIO lines of the chip that QEMU emulates.

import {once} from 'node:events';
import {createServer} from 'node:net';
import {createInterface} from 'node:readline';

/** Octurn's lines as it has them by default, by their numbers on the chip. */
const lines = {step: 17, direction: 27, enable: 5};

/** Microsteps of a turn: a motor of 1.8 degrees on the platform's shaft, in quarter steps. */
export const stepsPerTurn = 800;

/** Microsteps of the coils' period, four whole steps. The driver begins at one place of each when it gets power (A4988, table 2:
 * "home"). */
const stepsPerPeriod = 16;

/** As the resistors on the board have them until somebody drives the lines. */
const undriven = {[lines.step]: 0, [lines.direction]: 0, [lines.enable]: 1};

/** An A4988, a motor, and the platform on it. */
export class Turntable {
  #levels = {...undriven};
  #toLose = [];
  #lossPeriod = Infinity;
  #isAtHome = false;  // the driver, since it got power
  #actions = new Map();

  /** Where the platform stands, in microsteps counter-clockwise. */
  position = 0;

  /** Where it would stand if no step had been lost. */
  commanded = 0;

  /** Rising edges of STEP so far. */
  pulses = 0;

  /** Whether the driver's ENABLE has no contact, and its own resistor keeps the motor off. */
  isEnableStuck = false;

  get isOn() {
    return this.#levels[lines.enable] === 0 && !this.isEnableStuck;
  }

  /** Radians, counter-clockwise seen from above. */
  get angle() {
    return 2 * Math.PI * this.position / stepsPerTurn;
  }

  /** Radians, where it would stand if no step had been lost. */
  get commandedAngle() {
    return 2 * Math.PI * this.commanded / stepsPerTurn;
  }

  /** Of the pulses to come, the motor misses `count` after `after` others. */
  lose(count, after = 0) {
    this.#toLose = Array.from({length: count}, (_, i) => this.pulses + after + i + 1);
  }

  /** From now on the motor misses each `period`-th pulse, as one that is too weak for its load; Infinity: none. */
  loseEach(period) {
    this.#lossPeriod = period;
  }

  /** Power fails, and comes back: the lines are as nobody drives them, and as soon as the driver switches the motor on, that
   * jumps to the nearest place at which the driver begins. */
  losePower() {
    this.#levels = {...undriven};
    this.#isAtHome = true;
  }

  /** Has something happen after a pulse: after the 350th, say, in the middle of a move. */
  atPulse(number, action) {
    this.#actions.set(number, action);
  }

  /** A line of the chip changes. @param {number} line @param {0 | 1} level */
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

/** The GPIO block of QEMU's Raspberry Pi 3: its name, and its registers (BCM2835 peripherals, 6.1). */
const block = '/machine/soc/peripherals/gpio';
const registers = 0x3f200000;
const set = registers + 0x1c;
const functions = (line) => registers + 4 * Math.floor(line / 10);
const output = (line) => 1 << (3 * (line % 10));

/**
 * QEMU's own witness of the chip's lines: its test protocol tells each change of a line that is an output. A line that
 * becomes an input again keeps its level there, while a resistor would pull it.
 */
export class GpioWitness {
  #server;
  #socket;

  /** @param {(line: number, level: 0 | 1) => void} change */
  static async listen(change) {
    const witness = new GpioWitness();
    witness.#server = createServer((socket) => witness.#watch(socket, change)).listen(0, '127.0.0.1');
    await once(witness.#server, 'listening');
    return witness;
  }

  /** What QEMU is to be started with. */
  get options() {
    return ['-qtest', `tcp:127.0.0.1:${this.#server.address().port}`, '-qtest-log', 'none'];
  }

  /** Writes a register, as the chip's processor would. */
  write(register, value) {
    this.#socket.write(`writel 0x${register.toString(16)} 0x${value.toString(16)}\n`);
  }

  async close() {
    this.#socket?.destroy();
    this.#server.close();
    await once(this.#server, 'close');
  }

  #watch(socket, change) {
    this.#socket = socket;
    socket.on('error', () => {});  // QEMU is killed, as power is cut
    createInterface({input: socket}).on('line', (text) => {
      const [, level, line] = /^IRQ (raise|lower) ([0-9]+)$/.exec(text) ?? [];
      if (level) {
        change(Number(line), level === 'raise' ? 1 : 0);
      }
    });
    socket.write(`irq_intercept_out ${block}\n`);
    // GPIO0 to 8 are pulled up while the Pi boots, and so is ENABLE: QEMU's chip has no resistors.
    this.write(functions(lines.enable), output(lines.enable));
    this.write(set, 1 << lines.enable);
    this.write(functions(lines.enable), 0);
  }
}
