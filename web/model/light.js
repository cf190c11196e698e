// How much light reaches each corner of a mesh, computed once, so that it costs nothing in a frame: of the room
// (ambient occlusion) and of its one lamp (the shadow of the mesh on itself). Pure.

/** Unit vector from the object to the lamp: from the left, in front and above. */
export const toLamp = unit([-0.66, -0.46, 0.7]);

const cells = 100;        // of a depth map, across the mesh
const roomDirections = 32;
const lampDirections = 8;
const grazing = 0.15;     // cosine of incidence below which a cell of the depth map says nothing
const lampRadius = 0.1;   // as seen from the object, radians
const maxLooks = 12e6;    // corners times directions, some 0.3 s on a phone; a larger mesh has fewer directions
const goldenAngle = Math.PI * (3 - Math.sqrt(5));

/** @param {number[]} v @returns {number[]} */
function unit(v) {
  const length = Math.hypot(...v);
  return v.map((value) => value / length);
}

/** Directions that are spread evenly over a sphere: a Fibonacci lattice. @param {number} count @returns {number[][]} */
const ofRoom = (count) => Array.from({length: count}, (_, i) => {
  const z = 1 - (2 * i + 1) / count;
  const radius = Math.sqrt(1 - z * z);
  return [radius * Math.cos(i * goldenAngle), radius * Math.sin(i * goldenAngle), z];
});

/** Two unit vectors at right angles to a direction and to each other. @param {number[]} d */
function across([x, y, z]) {
  const u = unit(Math.abs(z) < 0.9 ? [y, -x, 0] : [0, z, -y]);
  return [u, [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]]];
}

/** Directions to points of the lamp. @param {number} count @returns {number[][]} */
export function ofLamp(count) {
  const [u, v] = across(toLamp);
  return Array.from({length: count}, (_, i) => {
    const radius = lampRadius * Math.sqrt((i + 0.5) / count);
    const [a, b] = [radius * Math.cos(i * goldenAngle), radius * Math.sin(i * goldenAngle)];
    return unit(toLamp.map((value, axis) => value + a * u[axis] + b * v[axis]));
  });
}

/** @param {Float32Array} positions @param {{center: number[], radius: number}} ball  around them */
function lookerAt(positions, {center, radius}) {
  const corners = positions.length / 3;
  const cell = 2 * radius / (cells - 2);
  const map = new Float32Array(cells * cells);
  const at = new Int32Array(corners);
  const depths = new Float32Array(corners);

  /**
   * Compares the depth of each corner with a depth map of all, along one direction.
   * @param {number[]} d @param {Int16Array} normals
   * @param {Float32Array} light  of each corner; receives its share of this direction's, weighted by incidence
   * @param {Float32Array} all  of each corner; receives what it would be if nothing were in the way
   */
  return (d, normals, light, all) => {
    const [u, v] = across(d);
    map.fill(-Infinity);
    for (let corner = 0, i = 0; corner < corners; ++corner, i += 3) {
      const [x, y, z] = [positions[i] - center[0], positions[i + 1] - center[1], positions[i + 2] - center[2]];
      const column = Math.floor((u[0] * x + u[1] * y + u[2] * z + radius) / cell);
      const row = Math.floor((v[0] * x + v[1] * y + v[2] * z + radius) / cell);
      const index = Math.min(row, cells - 1) * cells + Math.min(column, cells - 1);
      const depth = d[0] * x + d[1] * y + d[2] * z;
      at[corner] = index;
      depths[corner] = depth;
      if (depth > map[index]) {
        map[index] = depth;
      }
    }
    for (let corner = 0, i = 0; corner < corners; ++corner, i += 3) {
      const facing = (d[0] * normals[i] + d[1] * normals[i + 1] + d[2] * normals[i + 2]) / 32767;
      if (facing > grazing) {
        const own = cell * (0.5 + Math.SQRT2 * Math.sqrt(1 - facing * facing) / facing);  // a plane's range in its cell
        const behind = map[at[corner]] - depths[corner] - own;
        all[corner] += facing;
        light[corner] += facing * Math.min(1, Math.max(0, 1 - behind / (3 * cell)));
      }
    }
  };
}

/**
 * @param {Float32Array} positions  of the corners of a mesh's triangles @param {Int16Array} normals  of normals.js
 * @param {{center: number[], radius: number}} ball  around the mesh
 * @returns {Uint8Array} two numbers for each corner, 255 for 1: the shares of the room's light and of the lamp's
 *     that reach it
 */
export function lightOf(positions, normals, ball) {
  const corners = positions.length / 3;
  const look = lookerAt(positions, ball);
  const rounds = Math.min(1, maxLooks / corners / (roomDirections + lampDirections));
  const result = new Uint8Array(2 * corners);
  const sources = [ofRoom(Math.ceil(rounds * roomDirections)), ofLamp(Math.ceil(rounds * lampDirections))];
  sources.forEach((directions, channel) => {
    const [light, all] = [new Float32Array(corners), new Float32Array(corners)];
    directions.forEach((d) => look(d, normals, light, all));
    for (let corner = 0; corner < corners; ++corner) {
      result[2 * corner + channel] = Math.round(all[corner] > 0 ? 255 * light[corner] / all[corner] : 255);
    }
  });
  return result;
}
