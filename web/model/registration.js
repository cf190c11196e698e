// Finds how a surface lies on another one of nearly the same shape: principal axes first, then iterated closest points,
// point to plane (Chen and Medioni 1992). Pure.

import {faceNormals, lengthsOf} from './normals.js';

/** @typedef {import('./nearest.js').Surface} Surface */

/** @typedef {number[]} Transform  3 rows of a rotation and a shift: twelve numbers, by rows */

const tried = {points: 120, rounds: 8};
const better = {points: 500, rounds: 25};
const fine = {points: 3000, rounds: 40};
const finalists = 5;
const yaws = 24;
const settled = 2e-4;  // millimetres, and radians times the size: a smaller step ends the rounds
const trim = 3;  // pairs farther apart than so many medians are left out

/** @param {Transform} t @param {number} x @param {number} y @param {number} z @returns {[number, number, number]} */
export const moved = (t, x, y, z) => [
  t[0] * x + t[1] * y + t[2] * z + t[3], t[4] * x + t[5] * y + t[6] * z + t[7], t[8] * x + t[9] * y + t[10] * z + t[11],
];

/** The transform that does `first`, then `second`. @param {Transform} second @param {Transform} first */
function after(second, first) {
  return [0, 1, 2].flatMap((row) => [0, 1, 2, 3].map((column) =>
    [0, 1, 2].reduce((sum, k) => sum + second[4 * row + k] * first[4 * k + column],
        column === 3 ? second[4 * row + 3] : 0)));
}

/** The area-weighted middle of a surface and the matrix of its second moments about it. @param {Float32Array} p  positions */
function moments(p) {
  const middle = [0, 0, 0];
  const square = Array.from({length: 3}, () => [0, 0, 0]);
  let total = 0;
  lengthsOf(faceNormals(p)).forEach((length, triangle) => {
    const area = length / 2;
    total += area;
    const corners = [0, 3, 6].map((at) => [0, 1, 2].map((axis) => p[9 * triangle + at + axis]));
    const sum = [0, 1, 2].map((axis) => corners[0][axis] + corners[1][axis] + corners[2][axis]);
    for (let i = 0; i < 3; ++i) {
      middle[i] += area * sum[i] / 3;
      for (let j = 0; j <= i; ++j) {  // the integral of x_i x_j over a triangle
        const products = corners.reduce((all, corner) => all + corner[i] * corner[j], 0);
        square[i][j] += area * (sum[i] * sum[j] + products) / 12;
      }
    }
  });
  const centre = middle.map((value) => value / total);
  return {centre, matrix: [0, 1, 2].map((i) => [0, 1, 2].map((j) => {
    const [row, column] = i >= j ? [i, j] : [j, i];
    return square[row][column] / total - centre[i] * centre[j];
  }))};
}

/**
 * The eigenvectors of a symmetric matrix, that of the largest eigenvalue first, by Jacobi's rotations.
 * @param {number[][]} matrix
 */
function axesOf(matrix) {
  const a = matrix.map((row) => [...row]);
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 20; ++sweep) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      const angle = Math.atan2(2 * a[p][q], a[q][q] - a[p][p]) / 2;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      for (let k = 0; k < 3; ++k) {
        [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      }
      for (let k = 0; k < 3; ++k) {
        [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
        [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
      }
    }
  }
  const order = [0, 1, 2].sort((i, j) => a[j][j] - a[i][i]);
  return order.map((column) => v.map((row) => row[column]));
}

/** @param {number[][]} m */
const determinant = (m) => m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
  m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);

const orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
const eightSigns = [1, -1].flatMap((x) => [1, -1].flatMap((y) => [1, -1].map((z) => [x, y, z])));

/**
 * All rotations that take the axes of one surface to those of the other, in any order, and turns about the upright axis.
 * @param {number[][]} from @param {number[][]} to
 */
function rotations(from, to) {
  const all = [];
  for (const order of orders) {
    for (const signs of eightSigns) {
      const rotation = [0, 1, 2].map((row) => [0, 1, 2].map((column) =>
        [0, 1, 2].reduce((sum, k) => sum + signs[k] * to[order[k]][row] * from[k][column], 0)));
      if (determinant(rotation) > 0) {
        all.push(rotation);
      }
    }
  }
  for (let i = 0; i < yaws; ++i) {
    const [c, s] = [Math.cos(2 * Math.PI * i / yaws), Math.sin(2 * Math.PI * i / yaws)];
    all.push([[c, -s, 0], [s, c, 0], [0, 0, 1]]);
  }
  return all;
}

/**
 * Solves a symmetric system by Gauss's elimination.
 * @param {number[][]} m  with the right side as last column @returns {number[] | null}
 */
function solved(m) {
  const n = m.length;
  for (let i = 0; i < n; ++i) {
    const pivot = m.reduce((best, row, k) => k >= i && Math.abs(row[i]) > Math.abs(m[best][i]) ? k : best, i);
    [m[i], m[pivot]] = [m[pivot], m[i]];
    if (Math.abs(m[i][i]) < 1e-12) {
      return null;
    }
    for (let k = 0; k < n; ++k) {
      const factor = k === i ? 0 : m[k][i] / m[i][i];
      for (let j = i; factor !== 0 && j <= n; ++j) {
        m[k][j] -= factor * m[i][j];
      }
    }
  }
  return m.map((row, i) => row[n] / row[i]);
}

/**
 * A rotation about a point by a rotation vector (Rodrigues's formula), and a shift.
 * @param {number[]} step @param {number[]} centre @returns {Transform}
 */
function stepOf([rx, ry, rz, tx, ty, tz], [cx, cy, cz]) {
  const angle = Math.hypot(rx, ry, rz);
  const [x, y, z] = angle > 0 ? [rx / angle, ry / angle, rz / angle] : [1, 0, 0];
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const d = 1 - c;
  const r = [c + x * x * d, x * y * d - z * s, x * z * d + y * s, y * x * d + z * s, c + y * y * d, y * z * d - x * s,
    z * x * d - y * s, z * y * d + x * s, c + z * z * d];
  const shift = [tx + cx, ty + cy, tz + cz].map((value, i) =>
    value - (r[3 * i] * cx + r[3 * i + 1] * cy + r[3 * i + 2] * cz));
  return [0, 1, 2].flatMap((i) => [r[3 * i], r[3 * i + 1], r[3 * i + 2], shift[i]]);
}

/** @param {number[]} values */
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1] ?? Infinity;

/**
 * Improves a transform by closest points.
 * @param {number[][]} points @param {Surface} surface @param {Transform} first
 * @param {number} rounds  at most @param {number} size  of the object
 * @returns {{transform: Transform, error: number}}  error: median distance
 */
function improved(points, surface, first, rounds, size) {
  let transform = first;
  let error = Infinity;
  for (let round = 0; round < rounds; ++round) {
    const at = points.map(([x, y, z]) => moved(transform, x, y, z));
    const near = at.map(([x, y, z]) => surface.nearest(x, y, z));
    const distances = near.map(({distance}) => Math.abs(distance));
    error = median(distances);
    const limit = Math.max(trim * error, 1e-3);
    const centre = [0, 1, 2].map((axis) => at.reduce((sum, point) => sum + point[axis], 0) / at.length);
    const system = Array.from({length: 6}, () => new Array(7).fill(0));
    near.forEach(({x, y, z, nx, ny, nz}, i) => {
      if (distances[i] > limit) {
        return;
      }
      const [px, py, pz] = [at[i][0] - centre[0], at[i][1] - centre[1], at[i][2] - centre[2]];
      const row = [py * nz - pz * ny, pz * nx - px * nz, px * ny - py * nx, nx, ny, nz];
      const rest = (x - at[i][0]) * nx + (y - at[i][1]) * ny + (z - at[i][2]) * nz;
      for (let a = 0; a < 6; ++a) {
        for (let b = 0; b < 6; ++b) {
          system[a][b] += row[a] * row[b];
        }
        system[a][6] += row[a] * rest;
      }
    });
    system.forEach((row, i) => {
      row[i] += 1e-9 * (i < 3 ? size * size : 1) * points.length;  // a direction that nothing tells stays
    });
    const step = solved(system);
    if (!step) {
      break;
    }
    transform = after(stepOf(step, centre), transform);
    if (size * Math.hypot(...step.slice(0, 3)) + Math.hypot(...step.slice(3)) < settled) {
      break;
    }
  }
  return {transform, error};
}

/** Points of a surface, spread evenly by area. @param {Float32Array} p  positions @param {number} count */
function samples(p, count) {
  let total = 0;
  const areas = lengthsOf(faceNormals(p)).map((length) => total += length / 2);  // of all triangles so far
  const points = [];
  for (let n = 0, i = 0; n < count && total > 0; ++n) {
    while (areas[i] < (n + 0.5) / count * total) {
      ++i;
    }
    const u = Math.sqrt((n * 0.754877666) % 1);  // the R2 sequence, so that each run takes the same points
    const v = (n * 0.569840291) % 1;
    const t = 9 * i;
    points.push([0, 1, 2].map((axis) =>
      (1 - u) * p[t + axis] + u * (1 - v) * p[t + 3 + axis] + u * v * p[t + 6 + axis]));
  }
  return points;
}

/**
 * The transform that lays a surface on a reference.
 * @param {{positions: Float32Array, filled: Uint8Array | null}} mesh  of which only what was seen is laid
 * @param {{positions: Float32Array, min: number[], max: number[]}} reference
 * @param {Surface} surface  of the reference
 * @returns {{transform: Transform, error: number}}  error: median distance, millimetres
 */
export function register({positions, filled}, reference, surface) {
  const seen = filled ? positions.filter((_, i) => filled[Math.floor(i / 9) * 3] === 0) : positions;
  const size = Math.hypot(...reference.max.map((value, axis) => value - reference.min[axis]));
  const from = moments(positions);
  const to = moments(reference.positions);
  const few = samples(seen, tried.points);
  const all = rotations(axesOf(from.matrix), axesOf(to.matrix)).map((rotation) => {
    const first = rotation.flatMap((row, i) =>
      [...row, to.centre[i] - row.reduce((sum, value, k) => sum + value * from.centre[k], 0)]);
    return improved(few, surface, first, tried.rounds, size);
  }).sort((a, b) => a.error - b.error).slice(0, finalists);
  const some = samples(seen, better.points);
  const [best] = all.map(({transform}) => improved(some, surface, transform, better.rounds, size))
      .sort((a, b) => a.error - b.error);
  return improved(samples(seen, fine.points), surface, best.transform, fine.rounds, size);
}
