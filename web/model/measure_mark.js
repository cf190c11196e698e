// Marks two points of a model and the line between them, drawn on top of the model.

import {BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial} from '../three.js';

const colour = 0xf4c95d;
const dot = 11;  // pixels

/** @param {number[][]} points_mm  one or two, in the model's frame */
export function measureMark(points_mm) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points_mm.flat()), 3));
  const mark = new Group();
  mark.add(new Points(geometry, new PointsMaterial({color: colour, size: dot, sizeAttenuation: false, depthTest: false})));
  if (points_mm.length === 2) {
    mark.add(new LineSegments(geometry, new LineBasicMaterial({color: colour, depthTest: false})));
  }
  mark.renderOrder = 1;  // drawn on top of the model
  return mark;
}
