// The two point clouds of a fit: their placement, the camera on them, and picking of points.

import {BufferAttribute, BufferGeometry, Matrix4, PerspectiveCamera, Points, PointsMaterial, Sphere, Vector3} from '../three.js';

const pointSize = 2.6;  // pixels
const reachOfClick = 18;  // picking distance, pixels
const gap = 0.25;  // between clouds side by side, as a share of the sum of their radii
const sight = new Vector3(0.42, -0.83, 0.37);  // direction from the centre to the camera
const sightBeside = new Vector3(0, -0.9, 0.43);

/** @param {number[][]} points_mm @param {number} colour */
export function cloudOf(points_mm, colour) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points_mm.flat()), 3));
  geometry.computeBoundingSphere();
  const cloud = new Points(geometry, new PointsMaterial({color: colour, size: pointSize * Math.min(devicePixelRatio, 2), sizeAttenuation: false}));
  cloud.matrixAutoUpdate = false;
  return cloud;
}

export function makeEye() {
  const eye = new PerspectiveCamera(32);
  eye.up.set(0, 0, 1);
  return eye;
}

/** The transform that puts the second cloud beside the first. @param {any[]} clouds @returns {Matrix4} */
export function besides(clouds) {
  const [before, side] = clouds.map(({geometry}) => geometry.boundingSphere);
  const distance = (1 + gap) * (before.radius + side.radius);
  return new Matrix4().makeTranslation(before.center.x + distance - side.center.x, before.center.y - side.center.y, 0);
}

/**
 * Places the camera so that both clouds are visible.
 * @param {import('three').PerspectiveCamera} camera @param {any[]} clouds @param {boolean} isBeside  whether they are side by side
 * @returns {{middle: Vector3, distance: number, depth: number}}  the target, its distance, and the first cloud's radius
 */
export function lookAt(camera, clouds, isBeside) {
  const balls = clouds.map(({geometry, matrixWorld}) => geometry.boundingSphere.clone().applyMatrix4(matrixWorld));
  const {center: middle, radius} = balls.reduce((all, ball) => all.union(ball), new Sphere().copy(balls[0]));
  const {aspect} = camera;
  const reach = isBeside ? Math.max(balls[0].radius, balls[1].radius, radius / aspect) : radius / Math.min(1, aspect);
  const distance = 1.05 * reach / Math.sin(camera.fov / 2 * Math.PI / 180);
  camera.position.copy(middle).addScaledVector((isBeside ? sightBeside : sight).clone().normalize(), distance);
  camera.near = distance / 100;
  camera.far = distance * 20;
  camera.updateProjectionMatrix();
  return {middle, distance, depth: balls[0].radius};
}

/**
 * Picks a point near a pixel: of those within reach, the one nearest to the camera.
 * @param {any[]} clouds @param {import('three').PerspectiveCamera} camera @param {{clientWidth: number, clientHeight: number}} canvas
 * @param {number} x @param {number} y  pixels
 * @returns {{cloud: number, point_mm: number[]} | null}
 */
export function pointAt(clouds, camera, {clientWidth, clientHeight}, x, y) {
  const at = new Vector3();
  let best = {depth: Infinity, cloud: -1, index: -1};
  clouds.forEach((cloud, number) => {
    const positions = cloud.geometry.getAttribute('position');
    for (let index = 0; index < positions.count; ++index) {
      at.fromBufferAttribute(positions, index).applyMatrix4(cloud.matrixWorld).project(camera);
      const aside = Math.hypot((at.x + 1) / 2 * clientWidth - x, (1 - at.y) / 2 * clientHeight - y);
      if (aside < reachOfClick && at.z + aside * 1e-4 < best.depth) {
        best = {depth: at.z + aside * 1e-4, cloud: number, index};
      }
    }
  });
  if (best.cloud < 0) {
    return null;
  }
  at.fromBufferAttribute(clouds[best.cloud].geometry.getAttribute('position'), best.index);
  return {cloud: best.cloud, point_mm: [at.x, at.y, at.z]};
}
