// A streaming reader of binary STL, which keeps only the positions in memory.

import {text} from '../base/texts.js';

const headerBytes = 84;
const recordBytes = 50;  // normal, three corners, two bytes of attributes
const cornersAt = 12;
const cornersBytes = 36;
const attributesAt = 48;
const filledIn = 1;

/**
 * @typedef {Object} Mesh
 * @property {Float32Array} positions  nine coordinates for each triangle, in the file's order, millimetres
 * @property {Uint8Array | null} filled  255 for each corner of a filled-in triangle, 0 for others; null if none was filled in
 * @property {number[]} min
 * @property {number[]} max
 */

/** @param {Float32Array} positions */
export function bounds(positions) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    const axis = i % 3;
    min[axis] = Math.min(min[axis], positions[i]);
    max[axis] = Math.max(max[axis], positions[i]);
  }
  return {min, max};
}

/**
 * @param {AsyncIterable<Uint8Array> | Uint8Array[]} chunks
 * @param {(fraction: number) => void} [onProgress]
 * @returns {Promise<Mesh>}
 * @throws {Error} if the file is truncated, has trailing bytes, or is empty
 */
export async function readStl(chunks, onProgress = () => {}) {
  const header = new Uint8Array(headerBytes);
  const record = new Uint8Array(recordBytes);
  /** @type {Uint8Array | undefined} */
  let corners;
  /** @type {Uint8Array | null} */
  let filled = null;
  let bytes = 0;   // read so far
  let total = headerBytes;
  for await (const chunk of chunks) {
    let at = 0;
    while (at < chunk.length) {
      if (bytes >= total) {
        throw new Error(text('view.stl-beyond'));
      }
      const inHeader = bytes < headerBytes;
      const target = inHeader ? header : record;
      const offset = inHeader ? bytes : (bytes - headerBytes) % recordBytes;
      const count = Math.min(target.length - offset, chunk.length - at);
      target.set(chunk.subarray(at, at + count), offset);
      at += count;
      bytes += count;
      if (offset + count < target.length) {
        continue;
      }
      if (inHeader) {
        const triangles = new DataView(header.buffer).getUint32(80, true);
        total = headerBytes + triangles * recordBytes;
        corners = new Uint8Array(triangles * cornersBytes);
      } else {
        const triangle = (bytes - headerBytes) / recordBytes - 1;
        corners?.set(record.subarray(cornersAt, cornersAt + cornersBytes), triangle * cornersBytes);
        if (record[attributesAt] === filledIn) {
          filled ??= new Uint8Array(corners.length / 12);
          filled.fill(255, triangle * 3, triangle * 3 + 3);
        }
      }
    }
    if (corners) {
      onProgress(bytes / total);
    }
  }
  if (!corners || bytes < total) {
    throw new Error(text('view.stl-short'));
  }
  if (corners.length === 0) {
    throw new Error(text('view.stl-empty'));
  }
  const positions = new Float32Array(corners.buffer);  // all platforms with WebGL are little-endian
  return {positions, filled, ...bounds(positions)};
}
