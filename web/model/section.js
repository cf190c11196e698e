// Sections and sizes of a closed mesh, true to its triangles. Pure; positions are those of an STL, in millimetres.

/** @typedef {{normal: number[], distance: number}} Plane  the points p of it have normal·p = distance */
/** @typedef {{axes: number[][], origin: number[]}} Pose  a point p of the model is seen at (axes·p) + origin */

/** @param {number[]} a @param {number[]} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** A plane of the view, in the frame of the model. @param {Plane} plane @param {Pose} pose @returns {Plane} */
export const planeInModel = ({normal, distance}, {axes, origin}) => ({
  normal: [0, 1, 2].map((axis) => normal.reduce((sum, value, row) => sum + value * axes[row][axis], 0)),
  distance: distance - dot(normal, origin),
});

/** How far positions reach along three directions. @param {ArrayLike<number>} positions @param {number[][]} axes */
export function extents(positions, axes) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    for (let axis = 0; axis < 3; ++axis) {
      const [x, y, z] = axes[axis];
      const at = positions[i] * x + positions[i + 1] * y + positions[i + 2] * z;
      min[axis] = Math.min(min[axis], at);
      max[axis] = Math.max(max[axis], at);
    }
  }
  return {min, max};
}

/**
 * The box around a mesh in its pose.
 * @param {ArrayLike<number>} positions @param {Pose} pose
 */
export function boxOf(positions, {axes, origin}) {
  const {min, max} = extents(positions, axes);
  const placed = (/** @type {number[]} */ corner) => corner.map((value, axis) => value + origin[axis]);
  return {min: placed(min), max: placed(max)};
}

/** A number from -1 to 1 that no other place is likely to have. @param {number} u @param {number} v */
const markOf = (u, v) => Math.sin(1e4 * Math.sin(12.9898 * u + 78.233 * v + 1));
const maxUnmatched = 1e-4;  // rounding of the sum of a million marks is far less

/**
 * The outline of a mesh in a plane: its extents along two directions of the plane, and the area that it encloses,
 * without its holes. Each triangle adds the piece of outline in which it meets the plane, in the sense that its outer
 * side gives, so the area needs no loops (Green's theorem). But each piece has to begin where another one ends.
 * @param {ArrayLike<number>} positions @param {Plane} plane @param {number[]} u @param {number[]} v
 * @returns {{width: number, height: number, area: number | null} | null}  null: the plane misses the mesh; area null: the
 *     mesh is open there
 */
export function sectionOf(positions, {normal, distance}, u, v) {
  const [above, us, vs] = [new Float64Array(3), new Float64Array(3), new Float64Array(3)];
  const min = [Infinity, Infinity];
  const max = [-Infinity, -Infinity];
  const ends = [0, 0, 0, 0];  // u and v of where the piece begins and ends
  let twice = 0;
  let unmatched = 0;
  const [x, y, z] = normal;
  for (let i = 0; i < positions.length; i += 9) {
    let count = 0;
    for (let corner = 0; corner < 3; ++corner) {
      const at = i + 3 * corner;
      above[corner] = positions[at] * x + positions[at + 1] * y + positions[at + 2] * z - distance;
      count += above[corner] > 0 ? 1 : 0;
    }
    if (count === 0 || count === 3) {
      continue;
    }
    for (let corner = 0; corner < 3; ++corner) {
      const at = i + 3 * corner;
      us[corner] = positions[at] * u[0] + positions[at + 1] * u[1] + positions[at + 2] * u[2];
      vs[corner] = positions[at] * v[0] + positions[at + 1] * v[1] + positions[at + 2] * v[2];
    }
    for (let corner = 0; corner < 3; ++corner) {
      const next = (corner + 1) % 3;
      if (above[corner] > 0 !== above[next] > 0) {
        // From above to below, as in the triangle on the edge's other side: both get the same bits.
        const [high, low, end] = above[corner] > 0 ? [corner, next, 2] : [next, corner, 0];
        const share = above[high] / (above[high] - above[low]);
        ends[end] = us[high] + share * (us[low] - us[high]);
        ends[end + 1] = vs[high] + share * (vs[low] - vs[high]);
      }
    }
    twice += ends[0] * ends[3] - ends[2] * ends[1];
    unmatched += markOf(ends[0], ends[1]) - markOf(ends[2], ends[3]);
    min[0] = Math.min(min[0], ends[0], ends[2]);
    min[1] = Math.min(min[1], ends[1], ends[3]);
    max[0] = Math.max(max[0], ends[0], ends[2]);
    max[1] = Math.max(max[1], ends[1], ends[3]);
  }
  const area = Math.abs(unmatched) < maxUnmatched ? Math.abs(twice) / 2 : null;
  return max[0] > -Infinity ? {width: max[0] - min[0], height: max[1] - min[1], area} : null;
}
