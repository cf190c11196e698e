// Reproducible pseudorandom numbers.

/** @typedef {{below: (n: number) => number, chance: (p: number) => boolean, pick: <T>(list: T[]) => T, bytes: (n: number) => Buffer}} Random */

/** Mulberry32, 32 bits of state. @param {number} seed @returns {Random} */
export function makeRandom(seed) {
  let state = seed >>> 0;
  const next = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
  const below = (n) => Math.floor(next() * n);
  return {
    below,
    chance: (p) => next() < p,
    pick: (list) => list[below(list.length)],
    bytes: (n) => Buffer.from(Array.from({length: n}, () => below(256))),
  };
}
