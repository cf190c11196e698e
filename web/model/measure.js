// Measuring between two points of a model. Pure; points are millimetres in its frame.

import {millimetres} from '../base/format.js';
import {fixed, text} from '../base/texts.js';

/** Adds a point: the second of a pair, or the first of a new one. @param {number[][]} points @param {number[]} point */
export const withPoint = (points, point) => points.length === 1 ? [...points, point] : [point];

/** @param {number[][]} points  none, one or two */
export function measureText(points) {
  if (points.length < 2) {
    return text(points.length === 0 ? 'view.measure-first' : 'view.measure-second');
  }
  const [a, b] = points;
  const along = a.map((value, axis) => Math.abs(b[axis] - value));
  const [x, y, z] = along.map((value) => fixed(value, 1));
  return text('view.measured', {distance: millimetres(Math.hypot(...along), 1), x, y, z});
}
