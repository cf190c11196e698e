// Random damage to files and their text.

const odd = ['-1', '0', '1e308', '-1e308', '1e-300', '1e400', 'null', 'true', '""', '[]', '{}', '9007199254740993', '"\\u0000"', '[[[[]]]]', '4294967296', '0.1'];

/** Flips bits, cuts bytes out or off, repeats or replaces some. @returns {Buffer} */
export function damagedBytes(random, bytes) {
  const at = random.below(bytes.length);
  const to = Math.min(bytes.length, at + 1 + random.below(40));
  const flipped = Buffer.from(bytes);
  for (let i = 1 + random.below(8); i > 0; --i) {
    flipped[random.below(bytes.length)] ^= 1 << random.below(8);
  }
  return random.pick([
    () => flipped, () => flipped,
    () => bytes.subarray(0, at),
    () => Buffer.concat([bytes.subarray(0, at), bytes.subarray(to)]),
    () => Buffer.concat([bytes.subarray(0, to), bytes.subarray(at)]),
    () => Buffer.concat([bytes.subarray(0, at), random.bytes(to - at), bytes.subarray(to)]),
    () => Buffer.alloc(random.pick([0, bytes.length])),
  ])();
}

/** Replaces a value of a JSON text, so that it can still be parsed, or damages its bytes. @returns {Buffer} */
export function damagedJson(random, text) {
  const values = [...text.matchAll(/"[^"]*"(\s*:)?|-?\d[\d.e+-]*|true|false|null/g)].filter(([, isKey]) => !isKey);
  if (values.length === 0 || random.chance(0.1)) {
    return damagedBytes(random, Buffer.from(text));
  }
  const value = random.pick(values);
  const other = random.chance(0.6) ? random.pick(values)[0] : random.pick(odd);
  return Buffer.from(text.slice(0, value.index) + other + text.slice(value.index + value[0].length));
}
