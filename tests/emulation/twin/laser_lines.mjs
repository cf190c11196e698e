// The lasers of the appliance's twin, on the GPIO lines of the chip that QEMU emulates.

/** Octurn's lines as it has them by default, by their numbers on the chip. */
const lasers = new Map([[23, 'left'], [24, 'right']]);
const step = 17;

/** Knows which lasers are lit, and what must never be of them. */
export class LaserLines {
  #lit = new Set();

  /** How often each laser was switched on. */
  lights = {left: 0, right: 0};

  /** What was wrong with them so far: a laser that was lit while the platform made a step, or beside the other one. */
  faults = [];

  /** The laser that is lit, or `none`. */
  get lit() {
    return [...this.#lit][0] ?? 'none';
  }

  /** A line of the chip changes. @param {number} line @param {0 | 1} level */
  change(line, level) {
    const laser = lasers.get(line);
    if (laser === undefined) {
      if (line === step && level === 1 && this.#lit.size > 0) {
        this.faults.push(`the platform made a step while the ${this.lit} laser was lit`);
      }
    } else if (level === 0) {
      this.#lit.delete(laser);
    } else if (!this.#lit.has(laser)) {
      this.#lit.add(laser);
      ++this.lights[laser];
      if (this.#lit.size > 1) {
        this.faults.push('both lasers were lit');
      }
    }
  }

  /** Power fails: resistors pull the lines down. */
  losePower() {
    this.#lit.clear();
  }
}
