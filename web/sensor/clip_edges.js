// Picking and moving sides of the scanned space with a pointer. Pure; lengths are millimetres.

/** @typedef {import('./plans.js').Plan} Plan */
/** @typedef {import('./plans.js').Side} Side */

export const thinnest = 10;  // minimum extent of the space, millimetres
const farthest = 1000;

/**
 * The sides under a pixel: none, one, or the two of a corner.
 * @param {Plan} plan @param {Side} side @param {number[]} clip_mm @param {number} x @param {number} y  pixel
 * @param {number} reach  pixels
 * @returns {number[]} indexes into clip_mm
 */
export function edgesAt({toPixel}, {right, up}, clip_mm, x, y, reach) {
  const [left, low] = toPixel(clip_mm[right], clip_mm[up]);
  const [far, high] = toPixel(clip_mm[right + 3], clip_mm[up + 3]);
  if (x < left - reach || x > far + reach || y < high - reach || y > low + reach) {
    return [];
  }
  const nearer = (/** @type {number} */ a, /** @type {number} */ b, /** @type {number} */ axis) =>
    Math.min(Math.abs(a), Math.abs(b)) > reach ? [] : [Math.abs(a) < Math.abs(b) ? axis : axis + 3];
  return [...nearer(x - left, x - far, right), ...nearer(y - low, y - high, up)];
}

/**
 * Moves one side, rounded to a millimetre, and keeps the minimum distance to the opposite side.
 * @param {number[]} clip_mm @param {number} index @param {number} value
 */
export function withSide(clip_mm, index, value) {
  const other = clip_mm[(index + 3) % 6];
  const rounded = Math.max(-farthest, Math.min(farthest, Math.round(value)));
  const kept = index < 3 ? Math.min(rounded, other - thinnest) : Math.max(rounded, other + thinnest);
  return clip_mm.map((one, at) => at === index ? kept : one);
}

/** @param {number[]} edges @param {Side} side @returns {string} the CSS cursor over these edges */
export function cursorOf(edges, {right}) {
  if (edges.length === 2) {
    return edges[0] < 3 === edges[1] < 3 ? 'nesw-resize' : 'nwse-resize';
  }
  return edges.length === 0 ? '' : edges[0] % 3 === right ? 'ew-resize' : 'ns-resize';
}
