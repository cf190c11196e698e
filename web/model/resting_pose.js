// How a model lies on its side. An object rests on a face of its convex hull, however rough the surface is, and only on one that
// its center of mass is above: from any other it tips over.

import {ConvexHull} from '../three.js';

/** @typedef {import('three').Vector3} Vector3 */

/**
 * The face of the convex hull on which an object comes to rest that is put down on a place of its surface.
 * @param {Vector3[]} points  of the surface, at least four, not in one plane; their mean stands for the center of mass
 * @param {Vector3} place  in the points' frame
 * @returns {Vector3} the face's unit normal, outwards
 */
export function restingSide(points, place) {
  const {faces} = new ConvexHull().setFromPoints(points);
  const center = points.reduce((sum, point) => sum.add(point), place.clone().setScalar(0)).divideScalar(points.length);
  const height = (/** @type {any} */ {normal, constant}) => constant - normal.dot(center);  // of the center above the face
  // A ray from the center leaves the hull through the face whose plane it meets first.
  const faceAlong = (/** @type {Vector3} */ ray) => {
    const inverseDistance = (/** @type {any} */ face) => face.normal.dot(ray) / height(face);
    return faces.reduce((best, face) => inverseDistance(face) > inverseDistance(best) ? face : best);
  };
  let face = faceAlong(place.clone().sub(center));
  // Where the center is not above the face, it is above a lower one, and the object tips over to that.
  for (let next = faceAlong(face.normal); height(next) < height(face); next = faceAlong(face.normal)) {
    face = next;
  }
  return face.normal;
}
