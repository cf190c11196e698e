// Reads the live pictures. On a phone that would keep the page from answering, so a worker does it (live_worker.js),
// except in browsers whose workers have no canvas.

import {brighten, brightnessOf, colour, decoded} from './depth_picture.js';
import {movedShare, seenOf} from './live_picture.js';

/** @typedef {import('./live_picture.js').Rig} Rig */
/** @typedef {import('./live_picture.js').Seen} Seen */

/**
 * @typedef {Object} Request
 * @property {Blob} png
 * @property {number} width  of the picture to draw, pixels
 * @property {number} height
 * @property {boolean} isLight  whether it is a camera's picture and not a depth picture
 * @property {Rig | null} rig  null: the sensor's pose is not known
 *
 * @typedef {Object} Reading
 * @property {Uint8ClampedArray} pixels  to draw: red, green, blue, alpha
 * @property {Uint8Array | null} brightness  of each pixel of a depth picture
 * @property {Omit<Seen, 'inside'> | null} seen  null without a rig
 * @property {number} moved  share of the scanned space that differs from the picture before
 */

/** @type {{brightness: Uint8Array, seen: Seen} | null} the previous picture */
let before = null;

/**
 * @param {HTMLCanvasElement} canvas  or an OffscreenCanvas, of the picture's size
 * @param {Request} request @returns {Promise<Reading>}
 */
export async function readPicture(canvas, {png, width, isLight, rig}) {
  const {data: pixels} = await decoded(canvas, png);
  if (isLight) {
    brighten(pixels);
    return {pixels, brightness: null, seen: null, moved: 0};
  }
  const brightness = brightnessOf(pixels);
  const all = rig && seenOf(brightness, width, rig);
  colour(pixels, all?.inside ?? null);
  const moved = all && before ? movedShare(brightness, before.brightness, all, before.seen) : 0;
  before = all && {brightness, seen: all};
  const {inside: _, ...seen} = all ?? {inside: null};
  return {pixels, brightness, seen: all && /** @type {any} */ (seen), moved};
}
