// MD5 (RFC 1321), which HTTP Digest takes of a password. Browsers have no function for it.

const shifts = [[7, 12, 17, 22], [5, 9, 14, 20], [4, 11, 16, 23], [6, 10, 15, 21]];
const sines = Array.from({length: 64}, (_, i) => Math.floor(Math.abs(Math.sin(i + 1)) * 2 ** 32));

/** A message with its padding: whole blocks of 64 bytes. @param {Uint8Array} bytes */
function padded(bytes) {
  const blocks = new Uint8Array(64 * (((bytes.length + 8) >> 6) + 1));
  blocks.set(bytes);
  blocks[bytes.length] = 0x80;
  const view = new DataView(blocks.buffer);
  view.setUint32(blocks.length - 8, 8 * bytes.length, true);
  return view;
}

/** One of the 64 steps' function of three words, and the index of the block's word that it takes.
 * @param {number} i @param {number} b @param {number} c @param {number} d */
function step(i, b, c, d) {
  switch (i >> 4) {
    case 0: return [(b & c) | (~b & d), i];
    case 1: return [(d & b) | (~d & c), (5 * i + 1) & 15];
    case 2: return [b ^ c ^ d, (3 * i + 5) & 15];
    default: return [c ^ (b | ~d), (7 * i) & 15];
  }
}

/** @param {string} message @returns {string} 32 hexadecimal digits */
export function md5(message) {
  const view = padded(new TextEncoder().encode(message));
  let state = [0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476];
  for (let block = 0; block < view.byteLength; block += 64) {
    let [a, b, c, d] = state;
    for (let i = 0; i < 64; ++i) {
      const [mixed, index] = step(i, b, c, d);
      const sum = (a + mixed + sines[i] + view.getUint32(block + 4 * index, true)) | 0;
      const shift = shifts[i >> 4][i & 3];
      [a, b, c, d] = [d, (b + ((sum << shift) | (sum >>> (32 - shift)))) | 0, b, c];
    }
    state = state.map((word, i) => (word + [a, b, c, d][i]) | 0);
  }
  state.forEach((word, i) => view.setInt32(4 * i, word, true));
  return Array.from(new Uint8Array(view.buffer, 0, 16), (byte) => byte.toString(16).padStart(2, '0')).join('');
}
