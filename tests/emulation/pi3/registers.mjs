// Decodes writes to the chip's GPIO registers from QEMU's trace.

const base = 0x3f200000;  // of the GPIO block (BCM2835 peripherals, 6.1)
const [set, clear] = [0x1c, 0x28];
const output = 1;

/** QEMU's options to trace each write to a device register. */
export const traceOptions = ['-trace', 'memory_region_ops_write'];

/** Tracks the state of GPIO lines through register writes. */
export class GpioRegisters {
  #functions = new Map();

  /** @param {number[]} lines  to be tracked */
  constructor(lines) {
    this.lines = lines;
  }

  /**
   * @param {string} text  a line of the trace
   * @returns {{line: number, level?: 0 | 1, input?: true}[]} written levels, and lines that changed from output to input
   */
  take(text) {
    const [, address, value] = /addr 0x([0-9a-f]+) value 0x([0-9a-f]+) .*bcm2835_gpio/.exec(text) ?? [];
    if (address === undefined) {
      return [];
    }
    const register = parseInt(address, 16) - base;
    const bits = parseInt(value, 16);
    return this.lines.flatMap((line) => {
      // GPFSELn has three bits for each of ten lines; GPSET0 and GPCLR0 have one bit a line.
      if (register === 4 * Math.floor(line / 10)) {
        const now = (bits >>> (3 * (line % 10))) & 7;
        const before = this.#functions.get(line);
        this.#functions.set(line, now);
        return now === 0 && before === output ? [{line, input: true}] : [];
      }
      const isWritten = (register === set || register === clear) && (bits >>> line) & 1;
      return isWritten ? [{line, level: register === set ? 1 : 0}] : [];
    });
  }
}
