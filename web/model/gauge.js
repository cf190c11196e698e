// The sizes of a model of a block or of a ball, as calipers would measure them: between its faces, not to the outermost of its
// noise. Pure; millimetres.

import {faceNormals, lengthsOf} from './normals.js';
import {dot} from './section.js';

/** @typedef {{area: number, normal: number[], middle: number[]}} Facet */

const aligned = Math.cos(20 * Math.PI / 180);  // normals of a face, against its own
const thickness = 1.5;  // of a face: a Kinect's noise, and what remains of its pattern
const shareOfFaces = 0.75;  // of the surface above the foot: rounded edges and noise have the rest
const shareOfBall = 0.9;
const foot = 3;  // mm; unseen above the platform

/** Those above the foot that a scan has seen. @param {import('./stl.js').Mesh} mesh @returns {Facet[]} */
function facetsOf({positions, filled}) {
  const normals = faceNormals(positions);
  const facets = [];
  lengthsOf(normals).forEach((length, i) => {
    const middle = [0, 1, 2].map((axis) => [0, 3, 6].reduce((sum, corner) => sum + positions[9 * i + corner + axis], 0) / 3);
    if (length > 0 && middle[2] > foot && !filled?.[3 * i]) {
      facets.push({area: length / 2, normal: [0, 1, 2].map((axis) => normals[3 * i + axis] / length), middle});
    }
  });
  return facets;
}

/** @param {{area: number}[]} facets */
const areaOf = (facets) => facets.reduce((sum, {area}) => sum + area, 0);

/** The median of a quantity over a surface. @param {Facet[]} facets @param {(facet: Facet) => number} of */
function medianOf(facets, of) {
  const sorted = facets.map((facet) => ({area: facet.area, value: of(facet)})).sort((a, b) => a.value - b.value);
  let below = areaOf(sorted) / 2;
  return sorted.find(({area}) => (below -= area) <= 0)?.value ?? NaN;
}

/**
 * The longer and the shorter side of a block that stands on the platform, and its height.
 * @param {Facet[]} facets @returns {number[] | null}  null if it is none
 */
function blockOf(facets) {
  // Normals of the sides are multiples of a right angle apart: four times their angle is one angle.
  const walls = facets.filter(({normal}) => Math.abs(normal[2]) < 0.3);
  const [sin, cos] = [Math.sin, Math.cos].map((part) =>
    walls.reduce((sum, {area, normal}) => sum + area * part(4 * Math.atan2(normal[1], normal[0])), 0));
  const turn = Math.atan2(sin, cos) / 4;
  const along = [Math.cos(turn), Math.sin(turn), 0];
  const across = [-along[1], along[0], 0];
  const directions = [along, along.map((part) => -part), across, across.map((part) => -part), [0, 0, 1]];
  let covered = 0;
  const reaches = directions.map((direction) => {
    const face = facets.filter(({normal}) => dot(normal, direction) > aligned);
    const reach = medianOf(face, ({middle}) => dot(middle, direction));
    covered += areaOf(face.filter(({middle}) => Math.abs(dot(middle, direction) - reach) < thickness));
    return reach;
  });
  const sides = [reaches[0] + reaches[1], reaches[2] + reaches[3]].sort((a, b) => b - a);
  return covered > shareOfFaces * areaOf(facets) ? [...sides, reaches[4]] : null;
}

/** The diameter of a ball. @param {Facet[]} facets @returns {number | null}  null if it is none */
function ballOf(facets) {
  // Towards the centre from each place: a surface of a ball with radius r has it at middle - r normal. Least squares.
  const total = areaOf(facets);
  const mean = (/** @type {(facet: Facet) => number} */ of) =>
    facets.reduce((sum, facet) => sum + facet.area * of(facet), 0) / total;
  const middle = [0, 1, 2].map((axis) => mean((facet) => facet.middle[axis]));
  const normal = [0, 1, 2].map((axis) => mean((facet) => facet.normal[axis]));
  const radius = (mean((facet) => dot(facet.middle, facet.normal)) - dot(middle, normal)) / (1 - dot(normal, normal));
  const centre = middle.map((part, axis) => part - radius * normal[axis]);
  const distance = (/** @type {Facet} */ facet) => Math.hypot(...facet.middle.map((part, axis) => part - centre[axis]));
  const fitted = medianOf(facets, distance);
  const covered = areaOf(facets.filter((facet) => Math.abs(distance(facet) - fitted) < thickness));
  return covered > shareOfBall * total ? 2 * fitted : null;
}

/**
 * @param {import('./stl.js').Mesh} mesh  of a model that stands on z = 0
 * @returns {{kind: 'block' | 'ball' | 'neither', sizes: number[]}}  longer side, shorter side and height, or the diameter
 */
export function gaugeSizes(mesh) {
  const facets = facetsOf(mesh);
  const sides = blockOf(facets);
  if (sides) {
    return {kind: 'block', sizes: sides};
  }
  const diameter = ballOf(facets);
  return diameter ? {kind: 'ball', sizes: [diameter]} : {kind: 'neither', sizes: []};
}
