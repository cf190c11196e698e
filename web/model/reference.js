// Reads an STL of another program, which may be text. Pure.

import {bounds, readStl} from './stl.js';
import {text} from '../base/texts.js';

const maxTriangles = 4_000_000;

/** @param {Uint8Array} bytes  of a whole file @returns {Promise<import('./stl.js').Mesh>} @throws {Error} if it is no STL */
export async function readReference(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const isBinary = bytes.length >= 84 && bytes.length === 84 + 50 * view.getUint32(80, true);
  if (bytes.length > 84 + 50 * maxTriangles) {
    throw new Error(text('compare.too-large'));
  }
  if (isBinary) {
    return readStl([bytes]);
  }
  const words = new TextDecoder('latin1').decode(bytes);
  const numbers = [...words.matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/g)].flatMap(([, ...corner]) => corner.map(Number));
  if (numbers.length === 0 || numbers.length % 9 !== 0 || !numbers.every(Number.isFinite)) {
    throw new Error(text('compare.no-stl'));
  }
  const positions = new Float32Array(numbers);
  return {positions, filled: null, ...bounds(positions)};
}
