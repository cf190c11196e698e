// Depth images for tests, written without Octurn's own code.

import zlib from 'node:zlib';

const table = Array.from({length: 256}, (_, n) => {
  for (let i = 0; i < 8; ++i) {
    n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1;
  }
  return n >>> 0;
});

/** The CRC of PNG and ZIP, which older versions of node's zlib lack. @param {Buffer} bytes @returns {number} */
export const crc32 = zlib.crc32 ??
  ((bytes) => (bytes.reduce((sum, byte) => table[(sum ^ byte) & 255] ^ (sum >>> 8), 0xffffffff) ^ 0xffffffff) >>> 0);

function chunk(kind, content) {
  const bytes = Buffer.concat([Buffer.from(kind, 'latin1'), content]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(content.length);
  check.writeUInt32BE(crc32(bytes));
  return Buffer.concat([length, bytes, check]);
}

/** A PNG of 16-bit grey. @param {(u: number, v: number) => number} depth  of a pixel @returns {Buffer} */
export function depthPng(width, height, depth) {
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head[8] = 16;
  const rows = Buffer.alloc(height * (1 + 2 * width));
  for (let v = 0; v < height; ++v) {
    for (let u = 0; u < width; ++u) {
      rows.writeUInt16BE(depth(u, v), v * (1 + 2 * width) + 1 + 2 * u);
    }
  }
  return Buffer.concat([Buffer.from('89504e470d0a1a0a', 'hex'), chunk('IHDR', head),
    chunk('IDAT', zlib.deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}
