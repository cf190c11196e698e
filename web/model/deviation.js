// The deviations of a model from a reference: distances, figures, a histogram and colours. Pure.

import {Surface} from './nearest.js';
import {faceNormals, lengthsOf, rings} from './normals.js';
import {moved, register} from './registration.js';

/** @typedef {import('./stl.js').Mesh} Mesh */

export const bars = 41;  // of the histogram, over three tolerances to both sides

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
const unseen = [166, 172, 176];  // colour of what was filled in and is no measurement
const within = [94, 178, 98];
const outside = [[240, 196, 60], [233, 122, 44], [196, 40, 38]];  // too much material, up to three tolerances and beyond
const inside = [[70, 180, 200], [54, 118, 214], [70, 50, 170]];  // too little

/**
 * @typedef {Object} Deviations
 * @property {Float32Array} distances  of each corner, millimetres, positive outside the reference
 * @property {Float32Array} weights  of each corner, square millimetres; 0: filled in
 * @property {number[]} transform  from the model to the reference, twelve numbers by rows
 */

/** The area that belongs to each corner; 0 for what was filled in. @param {Mesh} mesh */
function weightsOf({positions: p, filled}) {
  const weights = new Float32Array(p.length / 3);
  lengthsOf(faceNormals(p)).forEach((length, i) => {
    weights.fill(filled?.[3 * i] ? 0 : length / 6, 3 * i, 3 * i + 3);
  });
  return weights;
}

/**
 * @param {Mesh} model @param {Mesh} reference
 * @param {{isPlaced?: boolean}} [how]  isPlaced: whether both are in one frame, as two models of a scan are
 * @returns {Deviations}
 */
export function deviations(model, reference, {isPlaced = false} = {}) {
  const surface = new Surface(reference);
  const {transform} = isPlaced ? {transform: identity} : register(model, reference, surface);
  const {positions} = model;
  const next = rings(positions);
  const distances = new Float32Array(positions.length / 3).fill(NaN);
  for (let corner = 0; corner < distances.length; ++corner) {
    if (!Number.isNaN(distances[corner])) {
      continue;
    }
    const [x, y, z] = moved(transform, positions[3 * corner], positions[3 * corner + 1], positions[3 * corner + 2]);
    const {distance} = surface.nearest(x, y, z);
    let other = corner;
    do {  // all corners at this place
      distances[other] = distance;
      other = next[other];
    } while (other !== corner);
  }
  return {distances, weights: weightsOf(model), transform};
}

/**
 * Figures of what was seen, by area.
 * @param {Pick<Deviations, 'distances' | 'weights'>} of @param {number} tolerance  millimetres
 */
export function figuresOf({distances, weights}, tolerance) {
  const counts = new Array(bars).fill(0);
  let [area, sum, absolute, square, good, max] = [0, 0, 0, 0, 0, 0];
  for (let i = 0; i < distances.length; ++i) {
    const [distance, weight] = [distances[i], weights[i]];
    if (weight === 0) {
      continue;
    }
    area += weight;
    sum += weight * distance;
    absolute += weight * Math.abs(distance);
    square += weight * distance * distance;
    good += Math.abs(distance) <= tolerance ? weight : 0;
    max = Math.max(max, Math.abs(distance));
    const bar = Math.floor((distance / (3 * tolerance) + 1) / 2 * bars);
    counts[Math.min(Math.max(bar, 0), bars - 1)] += weight;
  }
  const share = (/** @type {number} */ value) => area > 0 ? value / area : 0;
  return {
    mean: share(absolute), bias: share(sum), rms: Math.sqrt(share(square)), max, within: share(good), histogram: counts.map(share),
  };
}

/** @param {number} distance @param {number} tolerance */
export function colourOf(distance, tolerance) {
  const steps = Math.abs(distance) / tolerance;
  return steps <= 1 ? within : (distance > 0 ? outside : inside)[Math.min(Math.ceil(steps), 4) - 2];
}

/** Red, green and blue of each corner. @param {Pick<Deviations, 'distances' | 'weights'>} of @param {number} tolerance */
export function coloursOf({distances, weights}, tolerance) {
  const colours = new Uint8Array(3 * distances.length);
  for (let i = 0; i < distances.length; ++i) {
    colours.set(weights[i] === 0 ? unseen : colourOf(distances[i], tolerance), 3 * i);
  }
  return colours;
}
