// How a model lies on its side. An object rests on a face of its convex hull, however rough the surface is.

import {ConvexHull} from './three.js';

/** @typedef {import('three').Vector3} Vector3 */

/**
 * The face of the convex hull that lies over a place, as seen from the middle of the points.
 * @param {Vector3[]} points  at least four, not in one plane
 * @param {Vector3} place  in the points' frame
 * @returns {Vector3} the face's unit normal, outwards
 */
export function restingSide(points, place) {
  const {faces} = new ConvexHull().setFromPoints(points);
  const middle = points.reduce((sum, point) => sum.add(point), place.clone().setScalar(0)).divideScalar(points.length);
  const ray = place.clone().sub(middle);
  // The ray leaves the hull through the face whose plane it meets first.
  const inverseDistance = (/** @type {any} */ {normal, constant}) => normal.dot(ray) / (constant - normal.dot(middle));
  return faces.reduce((best, face) => inverseDistance(face) > inverseDistance(best) ? face : best).normal;
}
