// Analysis of the live picture before a scan: the readings in the scanned space. Pure, without texts, as it runs in a
// worker. The frames are those of pose.js; lengths are metres unless a name says millimetres.

import {distanceOf} from './depth_picture.js';

/** @typedef {import('./overlay.js').Sensor} Sensor */
/** @typedef {{pose: import('../base/pose.js').Matrix, sensor: Sensor, clip_mm: number[]}} Rig */

/**
 * @typedef {Object} Seen  the analysis of one picture
 * @property {Uint8Array} inside  1 for each pixel whose reading lies in the scanned space
 * @property {number} read_share  share of pixels with a reading
 * @property {number} object  number of object pixels, which surely show something on the platform
 * @property {number} nearest  depth of the object pixels, first percentile
 * @property {number} distance  depth of the object pixels, median
 * @property {number} width_mm  of the object, across the sensor's view
 * @property {number} height_mm  of the object, above the platform
 * @property {number} beyond_share  share of object pixels so far from the axis that they leave the space at some angle
 * @property {number} unread_share  share of pixels without a reading between object pixels of a row
 * @property {{top: number, side: number}} cut  number of pixels where the surface continues outside the space
 */

const clear_mm = 8;     // height above the space's floor; a pose 1 degree off lifts the platform's edge by 3 mm
const oneSurface = 0.012;  // metres between neighbouring pixels of a surface; one step of the picture is 4 mm at 0.75 m
const farthest = 24;    // brightness at the end of the range and beyond (API.md), so without a distance

/** The distance of each brightness. @param {Sensor} sensor */
const distancesOf = (sensor) => Float64Array.from({length: 256}, (_, brightness) => distanceOf(brightness, sensor.nearest_m) ?? 0);

/** @param {Float64Array} sorted @param {number} share */
const quantile = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];

/**
 * Computes points of pixels. One array takes all of them in turn, as arrays for 76,800 pixels of each picture would keep
 * a phone busy.
 * @param {Uint8Array} brightness  of each pixel, row by row @param {number} width @param {Rig} rig
 * @param {Float64Array} distances  of each brightness
 * @returns {(index: number, place: Float64Array) => void} sets `place` to the pixel's point in the platform's frame; NaN
 *     without a distance
 */
function placesOf(brightness, width, {pose, sensor}, distances) {
  const step = sensor.width / width;
  return (index, place) => {
    const z = brightness[index] > farthest ? distances[brightness[index]] : NaN;
    const x = z * (index % width * step - sensor.cx) / sensor.fx;
    const y = z * (Math.floor(index / width) * step - sensor.cy) / sensor.fy;
    for (let axis = 0; axis < 3; ++axis) {
      const row = pose[axis];
      place[axis] = row[0] * x + row[1] * y + row[2] * z + row[3];
    }
  };
}

/**
 * Counts pixels inside the space with a neighbour outside it on the same surface.
 * @param {ReturnType<typeof placesOf>} placeOf @param {Uint8Array} inside @param {number} width
 * @param {number[]} clip  metres
 */
function cutOf(placeOf, inside, width, clip) {
  const cut = {top: 0, side: 0};
  const [inner, outer] = [new Float64Array(3), new Float64Array(3)];
  const look = (/** @type {number} */ a, /** @type {number} */ b) => {
    if (inside[a] === inside[b]) {
      return;
    }
    placeOf(inside[a] ? a : b, inner);
    placeOf(inside[a] ? b : a, outer);
    const apart = Math.hypot(outer[0] - inner[0], outer[1] - inner[1], outer[2] - inner[2]);
    if (apart < oneSurface && outer[2] > clip[2] + clear_mm / 1000) {
      cut[outer[2] > clip[5] ? 'top' : 'side'] += 1;
    }
  };
  for (let index = 0; index + width < inside.length; ++index) {
    look(index, index + width);
    if ((index + 1) % width !== 0) {
      look(index, index + 1);
    }
  }
  return cut;
}

/**
 * The share of pixels without a reading between the first and the last object pixel of each row.
 * @param {Uint8Array} brightness @param {Uint8Array} isObject @param {number} width
 */
function unreadShare(brightness, isObject, width) {
  let unread = 0;
  let seen = 0;
  for (let start = 0; start < brightness.length; start += width) {
    const row = isObject.subarray(start, start + width);
    const [first, last] = [row.indexOf(1), row.lastIndexOf(1)];
    for (let x = first; x >= 0 && x <= last; ++x) {
      unread += brightness[start + x] === 0 ? 1 : 0;
      seen += row[x];
    }
  }
  return seen === 0 ? 0 : unread / (unread + seen);
}

/**
 * @param {Uint8Array} brightness  of each pixel (API.md), row by row
 * @param {number} width  pixels in a row
 * @param {Rig} rig
 * @returns {Seen}
 */
export function seenOf(brightness, width, rig) {
  const clip = rig.clip_mm.map((value) => value / 1000);
  const distances = distancesOf(rig.sensor);
  const placeOf = placesOf(brightness, width, rig, distances);
  const place = new Float64Array(3);
  const inside = new Uint8Array(brightness.length);
  const isObject = new Uint8Array(brightness.length);
  // Points nearer to the axis stay inside at every angle.
  const reach = Math.min(...[0, 1, 3, 4].map((side) => Math.abs(clip[side])));
  /** @type {Record<'depth' | 'across' | 'up', number[]>} coordinates of the object pixels */
  const all = {depth: [], across: [], up: []};
  let beyond = 0;
  let read = 0;
  for (let index = 0; index < brightness.length; ++index) {
    const value = brightness[index];
    read += value === 0 ? 0 : 1;
    placeOf(index, place);
    const [x, y, z] = [place[0], place[1], place[2]];
    const isInside = x >= clip[0] && y >= clip[1] && z >= clip[2] && x <= clip[3] && y <= clip[4] && z <= clip[5];
    inside[index] = isInside ? 1 : 0;
    isObject[index] = inside[index] && z > clip[2] + clear_mm / 1000 ? 1 : 0;
    if (isObject[index]) {
      all.depth.push(distances[value]);
      all.across.push(distances[value] * (index % width * rig.sensor.width / width - rig.sensor.cx) / rig.sensor.fx);
      all.up.push(z);
      beyond += Math.hypot(x, y) > reach ? 1 : 0;
    }
  }
  const object = all.depth.length;
  const [depth, across, up] = [all.depth, all.across, all.up].map((values) => Float64Array.from(values).sort());
  const span = (/** @type {Float64Array} */ values, from = quantile(values, 0.01)) =>
    object === 0 ? 0 : 1000 * (quantile(values, 0.99) - from);
  return {
    inside,
    object,
    read_share: read / brightness.length,
    nearest: object === 0 ? NaN : quantile(depth, 0.01),
    distance: object === 0 ? NaN : quantile(depth, 0.5),
    width_mm: span(across),
    height_mm: span(up, 0),
    beyond_share: object === 0 ? 0 : beyond / object,
    unread_share: unreadShare(brightness, isObject, width),
    cut: cutOf(placeOf, inside, width, clip),
  };
}

/**
 * The share of the scanned space's pixels whose distance differs between two pictures. Noise alone changes edges only.
 * @param {Uint8Array} brightness @param {Uint8Array} before @param {Seen} seen @param {Seen} seenBefore
 */
export function movedShare(brightness, before, seen, seenBefore) {
  const steps = 5;  // of brightness: 2 cm at 0.75 m
  let moved = 0;
  let all = 0;
  brightness.forEach((value, index) => {
    if (seen.inside[index] || seenBefore.inside[index]) {
      all += 1;
      moved += Math.abs(value - before[index]) > steps ? 1 : 0;
    }
  });
  return moved / Math.max(all, 400);
}
