// What a person did to a model in the view, as settings of a build. Pure.
//
// Positions of the settings are those of the model as scanned, in millimetres. The model in view may have been laid and
// scaled before.

import {dot, extents} from '../model/section.js';

/**
 * @typedef {Object} Edits
 * @property {number[][]} [cut_mm]
 * @property {number[][]} [erase_mm]
 * @property {number[] | null} [lay_mm]
 * @property {number} [scale]
 * @property {number | null} [max_triangles]
 */

/**
 * @typedef {Object} Done  in the frame of the model in view
 * @property {{normal: number[], distance: number} | null} cut  what lies beyond the plane in its direction is cut off
 * @property {number[][]} erased  balls: centre and radius
 * @property {{down: number[], point: number[]} | null} lay  the direction that becomes down, and the point that becomes
 *     the origin
 */

/**
 * The smallest rotation of a direction to -Z, row by row; from +Z the one about X.
 * @param {number[]} down
 */
function layingRows([x, y, z]) {
  if (z > 1 - 1e-9) {
    return [[1, 0, 0], [0, -1, 0], [0, 0, -1]];
  }
  const c = 1 / (1 - z);
  return [[1 - c * x * x, -c * x * y, x], [-c * x * y, 1 - c * y * y, y], [-x, -y, -z]];
}

/** The rows of the pose of a model that edits laid, its origin, and its scale. @param {Edits} edits */
function placeOf({lay_mm, scale}) {
  const rows = lay_mm ? layingRows(lay_mm.slice(0, 3)) : [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  return {rows, origin: lay_mm ? lay_mm.slice(3) : [0, 0, 0], scale: scale ?? 1};
}

/**
 * @param {Edits} before  of the model in view @param {Done} done
 * @returns {Edits} all of them
 */
export function composed(before, {cut, erased, lay}) {
  const {rows, origin, scale} = placeOf(before);
  const turnedBack = (/** @type {number[]} */ v) =>
    [0, 1, 2].map((axis) => rows[0][axis] * v[0] + rows[1][axis] * v[1] + rows[2][axis] * v[2]);
  const placedBack = (/** @type {number[]} */ p) => turnedBack(p).map((value, axis) => value / scale + origin[axis]);
  const normal = cut ? turnedBack(cut.normal) : [];
  const planes = cut ? [[...normal, cut.distance / scale + dot(normal, origin)]] : [];
  return {
    cut_mm: [...before.cut_mm ?? [], ...planes],
    erase_mm: [
      ...before.erase_mm ?? [],
      ...erased.map(([x, y, z, radius]) => [...placedBack([x, y, z]), radius / scale]),
    ],
    lay_mm: lay ? [...turnedBack(lay.down), ...placedBack(lay.point)] : before.lay_mm ?? null,
    scale,
  };
}

/**
 * The point below a model's middle on the plane that it rests on.
 * @param {ArrayLike<number>} positions  of all corners @param {number[]} up  of length one, in their frame
 */
export function restOf(positions, up) {
  const side = Math.abs(up[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0];
  const across = side.map((value, axis) => value - dot(side, up) * up[axis]);
  const length = Math.hypot(...across);
  const u = across.map((value) => value / length);
  const v = [up[1] * u[2] - up[2] * u[1], up[2] * u[0] - up[0] * u[2], up[0] * u[1] - up[1] * u[0]];
  const {min, max} = extents(positions, [u, v, up]);
  const at = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, min[2]];
  return [0, 1, 2].map((axis) => at[0] * u[axis] + at[1] * v[axis] + at[2] * up[axis]);
}

/**
 * The planes of a box.
 * @param {(number | null)[]} box_mm  its smallest x, y, z and its largest; null: open on that side
 */
export const planesOf = (box_mm) => box_mm.flatMap((at, index) => {
  if (at === null) {
    return [];
  }
  const sign = index < 3 ? -1 : 1;
  return [[0, 1, 2].map((axis) => axis === index % 3 ? sign : 0).concat(sign * at)];
});
