// The sensor's pose as in the API (platform from optical frame, metres) and as numbers for people. Pure. The suffixes _deg and _mm
// give the units; points are in metres in the frame of their name.

/** @typedef {number[][]} Matrix  four rows of four */
/** @typedef {[number, number, number]} Point */

/**
 * The sensor's position and direction, seen from behind it. A rotation about the platform's axis changes `yaw_deg` only. No picture
 * determines it; it only rotates models.
 *
 * @typedef {Object} Placement
 * @property {number} x_mm  to the right of the axis
 * @property {number} y_mm  beyond the axis; negative in front of it
 * @property {number} z_mm  height above the platform's surface
 * @property {number} tilt_deg  downwards
 * @property {number} roll_deg  clockwise, as the sensor sees
 * @property {number} yaw_deg  around the platform's axis, counter-clockwise from above
 */

const degrees = (/** @type {number} */ radians) => radians * 180 / Math.PI;
const radians = (/** @type {number} */ angle) => angle * Math.PI / 180;
const millimetres = (/** @type {number} */ metres) => 1000 * metres;

/** @param {number[][]} a @param {number[][]} b  3 x 3 */
const product = (a, b) => a.map((row) => [0, 1, 2].map((column) => row[0] * b[0][column] + row[1] * b[1][column] + row[2] * b[2][column]));

/** @param {number[][]} a */
const transposed = (a) => [0, 1, 2].map((row) => [0, 1, 2].map((column) => a[column][row]));

/** @param {number} angle  radians */
function aroundZ(angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [[c, -s, 0], [s, c, 0], [0, 0, 1]];
}

/** The rotation of a sensor that looks along Y, tilted down. @param {number} tilt  radians */
function lookingDown(tilt) {
  const [c, s] = [Math.cos(tilt), Math.sin(tilt)];
  return [[1, 0, 0], [0, -s, c], [0, -c, -s]];
}

/** @param {Placement} placement @returns {Matrix} optical frame to platform frame */
export function poseOf({x_mm, y_mm, z_mm, tilt_deg, roll_deg, yaw_deg}) {
  const heading = aroundZ(radians(yaw_deg));
  const rotation = product(heading, product(lookingDown(radians(tilt_deg)), aroundZ(radians(roll_deg))));
  const position = heading.map((row) => (row[0] * x_mm + row[1] * y_mm + row[2] * z_mm) / 1000);
  return [...rotation.map((row, index) => [...row, position[index]]), [0, 0, 0, 1]];
}

/** The inverse of poseOf, ambiguous for a sensor that looks straight down. @param {Matrix} pose @returns {Placement} */
export function placementOf(pose) {
  const rotation = pose.slice(0, 3).map((row) => row.slice(0, 3));
  const position = pose.slice(0, 3).map((row) => row[3]);
  const forward = rotation.map((row) => row[2]);
  const yaw = Math.atan2(-forward[0], forward[1]);
  const tilt = Math.asin(Math.max(-1, Math.min(1, -forward[2])));
  const back = transposed(aroundZ(yaw));
  const rolled = product(transposed(lookingDown(tilt)), product(back, rotation));
  const [x_mm, y_mm, z_mm] = back.map((row) => millimetres(row[0] * position[0] + row[1] * position[1] + row[2] * position[2]));
  return {x_mm, y_mm, z_mm, tilt_deg: degrees(tilt), roll_deg: degrees(Math.atan2(rolled[1][0], rolled[0][0])), yaw_deg: degrees(yaw)};
}

/** @param {Matrix} pose @param {Point} point  in the optical frame @returns {Point} in the platform's */
export const toPlatform = (pose, [x, y, z]) => /** @type {Point} */ (
  pose.slice(0, 3).map((row) => row[0] * x + row[1] * y + row[2] * z + row[3]));

/** @param {Matrix} pose @param {Point} point  in the platform's frame @returns {Point} in the optical one */
export function toSensor(pose, point) {
  const [x, y, z] = point.map((value, axis) => value - pose[axis][3]);
  return /** @type {Point} */ ([0, 1, 2].map((axis) => pose[0][axis] * x + pose[1][axis] * y + pose[2][axis] * z));
}

/**
 * The difference between two poses, for people.
 * @param {Matrix} pose @param {Matrix} other
 * @returns {{shift_mm: number, lift_mm: number, tilt_deg: number}} how far the axis moves at the platform's surface, how far
 *     that surface rises or sinks at the axis, and how far the axis turns
 */
export function differenceOf(pose, other) {
  const origin = toPlatform(pose, toSensor(other, [0, 0, 0]));
  const top = toPlatform(pose, toSensor(other, [0, 0, 1]));
  const along = top.map((value, axis) => value - origin[axis]);
  const share = along[2] === 0 ? 0 : origin[2] / along[2];  // along the axis, from the origin to the surface
  return {
    shift_mm: millimetres(Math.hypot(origin[0] - share * along[0], origin[1] - share * along[1])),
    lift_mm: Math.abs(millimetres(origin[2])),
    tilt_deg: degrees(Math.atan2(Math.hypot(along[0], along[1]), along[2])),
  };
}
