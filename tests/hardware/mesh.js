// Reads OpenSCAD's STL, and measures it.

import {readFileSync} from 'node:fs';

/** @returns {number[][][]} the triangles of an STL of text, each of three corners */
export function triangles(file) {
  const corners = [...readFileSync(file, 'utf8').matchAll(/vertex (\S+) (\S+) (\S+)/g)]
      .map((match) => match.slice(1).map(Number));
  return Array.from({length: corners.length / 3}, (_, i) => corners.slice(3 * i, 3 * i + 3));
}

/** @returns {number[][][]} the segments, each of two points [x, y], in which the mesh meets the plane of this z */
export function section(mesh, z) {
  return mesh.flatMap((corners) => {
    const points = corners.flatMap((a, i) => {
      const b = corners[(i + 1) % 3];
      if ((a[2] < z) === (b[2] < z)) {
        return [];
      }
      const part = (z - a[2]) / (b[2] - a[2]);
      return [[a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]];
    });
    return points.length === 2 ? [points] : [];
  });
}

/** @returns {number} a point's distance from a segment */
function distance([[ax, ay], [bx, by]], [x, y]) {
  const [dx, dy] = [bx - ax, by - ay];
  const along = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(ax + along * dx - x, ay + along * dy - y);
}

/** @returns {number} radius of the largest disc about a point that stays clear of the section */
export function clearRadius(segments, point) {
  return Math.min(...segments.map((segment) => distance(segment, point)));
}

/** @returns {number[]} least x, least y, greatest x, greatest y of the section */
export function extent(segments) {
  const points = segments.flat();
  const of = (choose, axis) => points.reduce((most, point) => choose(most, point[axis]), points[0][axis]);
  return [of(Math.min, 0), of(Math.min, 1), of(Math.max, 0), of(Math.max, 1)];
}
