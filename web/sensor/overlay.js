// The platform, its axis and the scanned space projected into the sensor's picture by a pose. Pure.

import {toSensor} from '../base/pose.js';

/** @typedef {import('../base/pose.js').Matrix} Matrix */
/** @typedef {import('../base/pose.js').Point} Point */
/**
 * @typedef {{width: number, height: number, fx: number, fy: number, cx: number, cy: number, nearest_m: number, best_m: number[], farthest_m: number}}
 *     Sensor  its camera, and the distances at which it measures
 */

const nearest = 0.05;  // near clipping plane, metres in front of the sensor
const ringSides = 72;

/**
 * @param {Sensor} sensor @param {Point} point  in the optical frame, in front of the sensor
 * @returns {[number, number]} pixel
 */
export const pixelOf = ({fx, fy, cx, cy}, [x, y, z]) => [cx + fx * x / z, cy + fy * y / z];

/** Clips a line to the space in front of the sensor; null if nothing is left. @param {Point} a @param {Point} b */
function before(a, b) {
  if (a[2] < nearest && b[2] < nearest) {
    return null;
  }
  const cut = (/** @type {Point} */ from, /** @type {Point} */ to) => {
    const share = (nearest - from[2]) / (to[2] - from[2]);
    return /** @type {Point} */ (from.map((value, axis) => value + share * (to[axis] - value)));
  };
  return [a[2] < nearest ? cut(a, b) : a, b[2] < nearest ? cut(b, a) : b];
}

/**
 * @param {Matrix} pose @param {Sensor} sensor @param {[Point, Point][]} lines  in the platform's frame, metres
 * @returns {string} SVG path
 */
function pathOf(pose, sensor, lines) {
  return lines.map(([a, b]) => before(toSensor(pose, a), toSensor(pose, b)))
      .map((ends) => ends ? `M${ends.map((end) => pixelOf(sensor, end).map((value) => value.toFixed(1)).join(' ')).join('L')}` : '')
      .join('');
}

/** @param {number} radius  metres @returns {[Point, Point][]} */
function ringLines(radius) {
  const point = (/** @type {number} */ index) => /** @type {Point} */ ([
    radius * Math.cos(2 * Math.PI * index / ringSides), radius * Math.sin(2 * Math.PI * index / ringSides), 0]);
  return Array.from({length: ringSides}, (_, index) => [point(index), point(index + 1)]);
}

/** @param {number[]} clip_mm @returns {[Point, Point][]} the twelve edges */
function boxLines(clip_mm) {
  const at = (/** @type {number} */ corner) => /** @type {Point} */ ([0, 1, 2].map((axis) => clip_mm[axis + (corner >> axis & 1 ? 3 : 0)] / 1000));
  return [0, 1, 2].flatMap((axis) => [0, 1, 2, 3, 4, 5, 6, 7].filter((corner) => !(corner >> axis & 1))
      .map((corner) => /** @type {[Point, Point]} */ ([at(corner), at(corner | 1 << axis)])));
}

/**
 * @param {{pose: Matrix, sensor: Sensor, clip_mm: number[], radius_mm: number}} rig
 * @returns {{ring: string, cross: string, axis: string, box: string}} SVG paths in the picture's pixels
 */
export function overlayOf({pose, sensor, clip_mm, radius_mm}) {
  const radius = radius_mm / 1000;
  const top = Math.max(clip_mm[5] / 1000, 0.05);
  const arm = 0.02;
  const path = (/** @type {[Point, Point][]} */ lines) => pathOf(pose, sensor, lines);
  return {
    ring: path([...ringLines(radius), ...ringLines(radius / 2)]),
    cross: path([[[-arm, 0, 0], [arm, 0, 0]], [[0, -arm, 0], [0, arm, 0]]]),
    axis: path([[[0, 0, 0], [0, 0, top]]]),
    box: path(boxLines(clip_mm)),
  };
}
