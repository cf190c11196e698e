// Finds the nearest point of a surface, in a grid of its triangles. Pure.

import {faceNormals, lengthsOf} from './normals.js';

const maxCells = 200_000;
const trianglesInCell = 2;  // on average, if they were spread over all cells; a surface fills a small part of them
const sameDistance = 1e-9;  // square millimetres: nearest points on several triangles are the same corner or edge

/**
 * @typedef {Object} Near  the nearest point of the surface, and the unit normal of its triangle
 * @property {number} x @property {number} y @property {number} z
 * @property {number} nx @property {number} ny @property {number} nz
 * @property {number} distance  positive outside
 */

/**
 * Writes the nearest point on a triangle to `out`: Ericson, Real-Time Collision Detection, 5.1.5.
 * @param {Float32Array} p  positions @param {number} t  index of the triangle's first coordinate
 * @param {number} x @param {number} y @param {number} z @param {Float64Array} out
 */
function nearestOnTriangle(p, t, x, y, z, out) {
  const [ax, ay, az] = [p[t], p[t + 1], p[t + 2]];
  const [abx, aby, abz] = [p[t + 3] - ax, p[t + 4] - ay, p[t + 5] - az];
  const [acx, acy, acz] = [p[t + 6] - ax, p[t + 7] - ay, p[t + 8] - az];
  const along = (/** @type {number} */ v, /** @type {number} */ w) => {
    out[0] = ax + v * abx + w * acx;
    out[1] = ay + v * aby + w * acy;
    out[2] = az + v * abz + w * acz;
  };
  const d1 = abx * (x - ax) + aby * (y - ay) + abz * (z - az);
  const d2 = acx * (x - ax) + acy * (y - ay) + acz * (z - az);
  if (d1 <= 0 && d2 <= 0) {
    return along(0, 0);
  }
  const [bx, by, bz] = [x - p[t + 3], y - p[t + 4], z - p[t + 5]];
  const d3 = abx * bx + aby * by + abz * bz;
  const d4 = acx * bx + acy * by + acz * bz;
  if (d3 >= 0 && d4 <= d3) {
    return along(1, 0);
  }
  const [cx, cy, cz] = [x - p[t + 6], y - p[t + 7], z - p[t + 8]];
  const d5 = abx * cx + aby * cy + abz * cz;
  const d6 = acx * cx + acy * cy + acz * cz;
  if (d6 >= 0 && d5 <= d6) {
    return along(0, 1);
  }
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return along(d1 / (d1 - d3), 0);
  }
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return along(0, d2 / (d2 - d6));
  }
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const w = (d4 - d3) / (d4 - d3 + d5 - d6);
    return along(1 - w, w);
  }
  const sum = va + vb + vc;
  return along(vb / sum, vc / sum);
}

export class Surface {
  #positions;
  #normals;
  #min = [0, 0, 0];
  #cell = 1;
  #counts = [1, 1, 1];
  #starts;
  #triangles;
  #seen;
  #stamp = 0;
  #out = new Float64Array(3);

  /** @param {{positions: Float32Array, min: number[], max: number[]}} mesh */
  constructor({positions, min, max}) {
    this.#positions = positions;
    const count = positions.length / 9;
    const faces = faceNormals(positions);
    const lengths = lengthsOf(faces);
    this.#normals = faces.map((part, i) => part / (lengths[Math.floor(i / 3)] || 1));
    const sides = max.map((value, axis) => Math.max(value - min[axis], 1e-3));
    const cells = Math.min(maxCells, Math.max(1, count / trianglesInCell) * 4);
    this.#cell = Math.cbrt(sides[0] * sides[1] * sides[2] / cells);
    this.#cell = Math.max(this.#cell, Math.max(...sides) / 256);
    this.#min = min;
    this.#counts = sides.map((side) => Math.floor(side / this.#cell) + 1);
    const [nx, ny, nz] = this.#counts;
    this.#starts = new Uint32Array(nx * ny * nz + 1);
    for (let i = 0; i < count; ++i) {
      this.#eachCell(i, (cell) => ++this.#starts[cell + 1]);
    }
    for (let cell = 0; cell < nx * ny * nz; ++cell) {
      this.#starts[cell + 1] += this.#starts[cell];
    }
    const next = this.#starts.slice();
    this.#triangles = new Uint32Array(this.#starts[nx * ny * nz]);
    for (let i = 0; i < count; ++i) {
      this.#eachCell(i, (cell) => {
        this.#triangles[next[cell]++] = i;
      });
    }
    this.#seen = new Uint32Array(count);
  }

  /** @param {number} value @param {number} axis */
  #index(value, axis) {
    return Math.min(Math.max(Math.floor((value - this.#min[axis]) / this.#cell), 0), this.#counts[axis] - 1);
  }

  /**
   * Calls back for the cells of a triangle's box that its plane may cross.
   * @param {number} i @param {(cell: number) => void} use
   */
  #eachCell(i, use) {
    const p = this.#positions;
    const t = 9 * i;
    const [from, to] = [Math.min, Math.max].map((pick) =>
      [0, 1, 2].map((axis) => this.#index(pick(p[t + axis], p[t + 3 + axis], p[t + 6 + axis]), axis)));
    const [nx, ny, nz] = this.#normals.subarray(3 * i, 3 * i + 3);
    const half = this.#cell / 2;
    const reach = half * (Math.abs(nx) + Math.abs(ny) + Math.abs(nz)) * 1.001 + 1e-3;
    const offset = nx * p[t] + ny * p[t + 1] + nz * p[t + 2];
    for (let z = from[2]; z <= to[2]; ++z) {
      for (let y = from[1]; y <= to[1]; ++y) {
        const rest = ny * (this.#min[1] + y * this.#cell + half) + nz * (this.#min[2] + z * this.#cell + half) - offset;
        for (let x = from[0]; x <= to[0]; ++x) {
          if (Math.abs(nx * (this.#min[0] + x * this.#cell + half) + rest) <= reach) {
            use((z * this.#counts[1] + y) * this.#counts[0] + x);
          }
        }
      }
    }
  }

  /**
   * The nearest point of the surface. Where triangles meet, the triangle that the point is farthest in front of or
   * behind decides the side.
   * @param {number} x @param {number} y @param {number} z @returns {Near}
   */
  nearest(x, y, z) {
    const middle = [this.#index(x, 0), this.#index(y, 1), this.#index(z, 2)];
    const best = {square: Infinity, triangle: 0, x: 0, y: 0, z: 0, steep: 0};
    ++this.#stamp;
    const last = Math.max(...this.#counts);
    for (let ring = 0; ring <= last; ++ring) {
      if (ring > 1 && best.square <= ((ring - 1) * this.#cell) ** 2) {
        break;
      }
      this.#eachOfRing(middle, ring, (cell) => this.#look(cell, x, y, z, best));
    }
    const [nx, ny, nz] = this.#normals.subarray(3 * best.triangle, 3 * best.triangle + 3);
    const side = (x - best.x) * nx + (y - best.y) * ny + (z - best.z) * nz < 0 ? -1 : 1;
    return {x: best.x, y: best.y, z: best.z, nx, ny, nz, distance: side * Math.sqrt(best.square)};
  }

  /** @param {number[]} middle @param {number} ring @param {(cell: number) => void} use */
  #eachOfRing([mx, my, mz], ring, use) {
    const [nx, ny, nz] = this.#counts;
    for (let z = Math.max(mz - ring, 0); z <= Math.min(mz + ring, nz - 1); ++z) {
      for (let y = Math.max(my - ring, 0); y <= Math.min(my + ring, ny - 1); ++y) {
        const isWhole = Math.abs(z - mz) === ring || Math.abs(y - my) === ring;
        const step = isWhole ? 1 : Math.max(2 * ring, 1);
        for (let x = isWhole ? Math.max(mx - ring, 0) : mx - ring; x <= Math.min(mx + ring, nx - 1); x += step) {
          if (x >= 0) {
            use((z * ny + y) * nx + x);
          }
        }
      }
    }
  }

  /** @param {number} cell @param {number} x @param {number} y @param {number} z @param {any} best */
  #look(cell, x, y, z, best) {
    for (let at = this.#starts[cell]; at < this.#starts[cell + 1]; ++at) {
      const i = this.#triangles[at];
      if (this.#seen[i] === this.#stamp) {
        continue;
      }
      this.#seen[i] = this.#stamp;
      nearestOnTriangle(this.#positions, 9 * i, x, y, z, this.#out);
      const [dx, dy, dz] = [x - this.#out[0], y - this.#out[1], z - this.#out[2]];
      const square = dx * dx + dy * dy + dz * dz;
      if (square > best.square + sameDistance) {
        continue;
      }
      const steep = Math.abs(dx * this.#normals[3 * i] + dy * this.#normals[3 * i + 1] + dz * this.#normals[3 * i + 2]);
      if (square < best.square - sameDistance || steep > best.steep) {
        Object.assign(best, {square, triangle: i, x: this.#out[0], y: this.#out[1], z: this.#out[2], steep});
      }
    }
  }
}
