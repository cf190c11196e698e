// Handles of the scanned space in the live picture: one on each side, to be dragged along the side's axis. Pure.

import {pixelOf} from './overlay.js';
import {toPlatform, toSensor} from '../base/pose.js';

/** @typedef {import('../base/pose.js').Matrix} Matrix */
/** @typedef {import('../base/pose.js').Point} Point */
/** @typedef {import('./overlay.js').Sensor} Sensor */

/** @typedef {{index: number, x: number, y: number, at_mm: Point}} Handle  index into clip_mm; x and y in the picture; at_mm on the side */

const nearest = 0.05;  // metres in front of the sensor
const margin = 14;     // pixels from the picture's edge, so that handles are wholly visible
const places = [0.5, 0.35, 0.65, 0.2, 0.8, 0.08, 0.92];  // candidate positions along a side, the middle first
const along = 0.1;     // sine of the angle between view and axis below which dragging is ill-conditioned

const metres = (/** @type {Point} */ point) => /** @type {Point} */ (point.map((value) => value / 1000));

/**
 * The handle of a side: as near to its middle as is visible.
 * @param {Matrix} pose @param {Sensor} sensor @param {number[]} clip_mm @param {number} index @returns {Handle | null}
 */
function handleOf(pose, sensor, clip_mm, index) {
  const [first, second] = [0, 1, 2].filter((axis) => axis !== index % 3);
  for (const share of places) {
    for (const other of places) {
      const at_mm = /** @type {Point} */ ([0, 0, 0]);
      at_mm[index % 3] = clip_mm[index];
      at_mm[first] = clip_mm[first] + share * (clip_mm[first + 3] - clip_mm[first]);
      at_mm[second] = clip_mm[second] + other * (clip_mm[second + 3] - clip_mm[second]);
      const seen = toSensor(pose, metres(at_mm));
      const [x, y] = pixelOf(sensor, seen);
      if (seen[2] > nearest && x >= margin && y >= margin && x <= sensor.width - margin && y <= sensor.height - margin) {
        return {index, x, y, at_mm};
      }
    }
  }
  return null;
}

/** @param {{pose: Matrix, sensor: Sensor, clip_mm: number[]}} rig @returns {Handle[]} of the visible sides */
export const handlesOf = ({pose, sensor, clip_mm}) => [0, 1, 2, 3, 4, 5]
    .map((index) => handleOf(pose, sensor, clip_mm, index)).filter((handle) => handle !== null);

/**
 * The position along its axis to which a handle is dragged: the axis's point nearest to a pixel's ray.
 * @param {{pose: Matrix, sensor: Sensor}} rig @param {Handle} handle  at the start of the drag
 * @param {number} x @param {number} y  pixel
 * @returns {number | null} millimetres, for clip_mm; null if the view is parallel to the axis
 */
export function draggedTo({pose, sensor}, {index, at_mm}, x, y) {
  const eye = toPlatform(pose, [0, 0, 0]);
  const far = toPlatform(pose, [(x - sensor.cx) / sensor.fx, (y - sensor.cy) / sensor.fy, 1]);
  const ray = far.map((value, axis) => value - eye[axis]);
  const axis = index % 3;
  const length = ray.reduce((sum, value) => sum + value * value, 0);
  const sineSquared = 1 - ray[axis] * ray[axis] / length;
  if (sineSquared < along * along) {
    return null;
  }
  const from = metres(at_mm).map((value, one) => value - eye[one]);
  const share = from.reduce((sum, value, one) => sum + value * ray[one], 0) / length;
  return at_mm[axis] + 1000 * (share * ray[axis] - from[axis]) / sineSquared;
}
