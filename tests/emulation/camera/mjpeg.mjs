// An encoder of motion JPEG for pictures of uniform blocks of 8 x 8 pixels, whose decoded pixels are exact. Like most cameras, it leaves
// out the Huffman tables, which are those of ITU-T T.81, annex K.

/** Code words of the DC difference by its number of bits (table K.3), and the code words of the end of a block. */
const differences = ['00', '010', '011', '100', '101', '110', '1110', '11110', '111110'];
const [endOfLuminance, colourless] = ['1010', '00' + '00'];

const segment = (marker, ...bytes) => [0xff, marker, bytes.length + 2 >> 8, bytes.length + 2 & 0xff, ...bytes];
const word = (value) => [value >> 8, value & 0xff];

/** Quantisation by 8 makes a unit of the DC coefficient one grey level. */
const quanta = (table) => segment(0xdb, table, ...new Array(64).fill(8));

/** The code of a difference of levels: its number of bits, then the bits, of value - 1 if it is negative (T.81, F.1.2.1). */
function difference(value) {
  const bits = 32 - Math.clz32(Math.abs(value));
  return differences[bits] + (bits === 0 ? '' : (value > 0 ? value : value + (1 << bits) - 1).toString(2).padStart(bits, '0'));
}

/** Packs bits into bytes, with a zero byte stuffed after 0xff. */
function packed(bits) {
  const padded = bits + '1'.repeat((8 - bits.length % 8) % 8);
  const bytes = [];
  for (let at = 0; at < padded.length; at += 8) {
    const byte = parseInt(padded.substring(at, at + 8), 2);
    bytes.push(byte, ...(byte === 0xff ? [0] : []));
  }
  return bytes;
}

/**
 * A grey JPEG in 4:2:2, with neutral chrominance.
 * @param {{width: number, height: number}} size  multiples of 8
 * @param {(x: number, y: number) => number} level  of the block in this column and row of blocks
 */
export function mjpeg({width, height}, level) {
  const sampling = [3, 1, 0x21, 0, 2, 0x11, 1, 3, 0x11, 1];  // two luminance blocks side by side, one block of each chrominance
  const last = width / 8 - 1;
  let before = 128;
  let bits = '';
  for (let y = 0; y < height / 8; ++y) {
    for (let x = 0; x <= last; x += 2) {
      for (const column of [x, Math.min(x + 1, last)]) {
        const now = level(column, y);
        bits += difference(now - before) + endOfLuminance;
        before = now;
      }
      bits += colourless + colourless;
    }
  }
  return Buffer.from([
    0xff, 0xd8, ...quanta(0), ...quanta(1), ...segment(0xc0, 8, ...word(height), ...word(width), ...sampling),
    ...segment(0xda, 3, 1, 0x00, 2, 0x11, 3, 0x11, 0, 63, 0), ...packed(bits), 0xff, 0xd9]);
}
