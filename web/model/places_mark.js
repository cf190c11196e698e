// Marks places of a model by a cloud of dots drawn on top of it.

import {BufferAttribute, BufferGeometry, Points, PointsMaterial, Sphere, Vector3} from '../three.js';

const colour = 0xff6a4d;
const blob = 9;  // pixels

/** @param {number[][]} points_mm  in the model's frame, at least one */
export function placesMark(points_mm) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points_mm.flat()), 3));
  const mark = new Points(geometry, new PointsMaterial({
    color: colour, size: blob, sizeAttenuation: false, transparent: true, opacity: 0.75, depthTest: false,
  }));
  mark.renderOrder = 1;  // drawn on top of the model
  return mark;
}

/**
 * The sphere around the places' centroid that holds nine tenths of them.
 * @param {number[][]} points_mm
 */
export function ballOf(points_mm) {
  const points = points_mm.map((point) => new Vector3(...point));
  const middle = points.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(points.length);
  const distances = points.map((point) => point.distanceTo(middle)).sort((a, b) => a - b);
  return new Sphere(middle, distances[Math.floor(0.9 * (distances.length - 1))]);
}
