// Normals that make the triangles of a smooth surface look like one, and keep its edges.

const crease = Math.cos(40 * Math.PI / 180);  // triangles that meet at a larger angle have an edge between them
const maxAround = 64;  // corners at one place that are looked at; more than a mesh has, and few enough for a hostile one

/**
 * Links the corners that have the same position to rings.
 * @param {Float32Array} positions
 * @returns {Int32Array} for each corner the next one of its ring
 */
export function rings(positions) {
  const corners = positions.length / 3;
  const bits = new Uint32Array(positions.buffer, positions.byteOffset, positions.length);
  const slots = new Int32Array(2 ** Math.ceil(Math.log2(2 * corners))).fill(-1);
  const next = new Int32Array(corners);
  for (let corner = 0; corner < corners; ++corner) {
    const [x, y, z] = [bits[3 * corner], bits[3 * corner + 1], bits[3 * corner + 2]];
    let slot = Math.imul(Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca77) ^ z, 0xc2b2ae3d) >>> 7;
    for (;; ++slot) {
      slot &= slots.length - 1;
      const other = slots[slot];
      if (other < 0) {
        slots[slot] = next[corner] = corner;
        break;
      }
      if (bits[3 * other] === x && bits[3 * other + 1] === y && bits[3 * other + 2] === z) {
        next[corner] = next[other];
        next[other] = corner;
        break;
      }
    }
  }
  return next;
}

/** The normals of the triangles, three numbers each, as long as twice their areas. @param {Float32Array} p  positions */
export function faceNormals(p) {
  const normals = new Float32Array(p.length / 3);
  for (let at = 0; at < p.length; at += 9) {
    const [ax, ay, az] = [p[at + 3] - p[at], p[at + 4] - p[at + 1], p[at + 5] - p[at + 2]];
    const [bx, by, bz] = [p[at + 6] - p[at], p[at + 7] - p[at + 1], p[at + 8] - p[at + 2]];
    normals[at / 3] = ay * bz - az * by;
    normals[at / 3 + 1] = az * bx - ax * bz;
    normals[at / 3 + 2] = ax * by - ay * bx;
  }
  return normals;
}

/** The lengths of vectors of three numbers each. @param {Float32Array} v */
export const lengthsOf = (v) =>
  Float64Array.from({length: v.length / 3}, (_, i) => Math.hypot(v[3 * i], v[3 * i + 1], v[3 * i + 2]));

/**
 * The normal of each corner: the mean over the triangles at its position, weighted by area, that are no edge away.
 * @param {Float32Array} positions  nine coordinates for each triangle
 * @returns {Int16Array} three numbers for each corner, 32767 for 1
 */
export function smoothNormals(positions) {
  const next = rings(positions);
  const faces = faceNormals(positions);
  const lengths = lengthsOf(faces);
  const normals = new Int16Array(positions.length);
  for (let corner = 0; corner < next.length; ++corner) {
    const own = Math.floor(corner / 3);
    let [x, y, z] = [0, 0, 0];
    let around = corner;
    for (let i = 0; i < maxAround; ++i) {
      const face = Math.floor(around / 3);
      const [fx, fy, fz] = [faces[3 * face], faces[3 * face + 1], faces[3 * face + 2]];
      if (face === own || faces[3 * own] * fx + faces[3 * own + 1] * fy + faces[3 * own + 2] * fz > crease * lengths[own] * lengths[face]) {
        x += fx;
        y += fy;
        z += fz;
      }
      around = next[around];
      if (around === corner) {
        break;
      }
    }
    const scale = 32767 / (Math.hypot(x, y, z) || 1);
    normals[3 * corner] = Math.round(x * scale);
    normals[3 * corner + 1] = Math.round(y * scale);
    normals[3 * corner + 2] = Math.round(z * scale);
  }
  return normals;
}
