// Pictures without compression, which have colours for two pixels of a row each.

import {pictureBytes} from './uvc_descriptors.mjs';

/** A picture without colours. @param {{width: number, height: number}} size @param {Uint8Array} luminance  of its pixels, row by row */
export function yuy2(size, luminance) {
  const bytes = Buffer.alloc(pictureBytes(size), 128);  // no colour
  for (let i = 0; i < luminance.length; ++i) {
    bytes[2 * i] = luminance[i];
  }
  return bytes;
}
