// Two clouds of points in 3D: one laid over the other, or side by side to set pairs of points.

import {
  BufferAttribute, BufferGeometry, Fog, Group, Matrix4, Mesh, MeshBasicMaterial, OrbitControls, PerspectiveCamera, Points, PointsMaterial, Scene,
  Sphere, SphereGeometry, Vector3, WebGLRenderer,
} from './three.js';
import {fitToCanvas, onClick} from './canvas.js';

/** @typedef {{before_mm: number[][], pose_mm: number[][]}} Clouds */

const colours = [0x35c4bd, 0xf09a3e];  // seen before, and the side
const pairColours = [0xff5c8a, 0xffe14d, 0x9b8cff];
const pointSize = 2.6;  // pixels
const reachOfClick = 18;  // pixels
const darkness = 0x14272f;  // that points far from the eye fade to
const gap = 0.25;  // between clouds side by side, of the larger one's breadth
const sight = new Vector3(0.42, -0.83, 0.37);  // from the middle to the eye

/** @param {number[][]} points_mm @param {number} colour */
function cloudOf(points_mm, colour) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points_mm.flat()), 3));
  geometry.computeBoundingSphere();
  const cloud = new Points(geometry, new PointsMaterial({color: colour, size: pointSize * Math.min(devicePixelRatio, 2), sizeAttenuation: false}));
  cloud.matrixAutoUpdate = false;
  return cloud;
}

/** @param {number} pair @param {number} radius */
function markOf(pair, radius) {
  const mark = new Mesh(new SphereGeometry(radius, 16, 12), new MeshBasicMaterial({color: pairColours[pair], depthTest: false, fog: false}));
  mark.renderOrder = 1;
  return mark;
}

export class FitViewer {
  #canvas;
  #onPoint;
  #renderer;
  #camera = new PerspectiveCamera(32);
  #scene = new Scene();
  #controls;
  #marks = new Group();
  /** @type {any[]} what was seen before, and the side */
  #clouds = [];
  #isBeside = false;
  #isFrameDue = false;
  /** @type {number[] | null} where the pointer went down */

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {(point_mm: number[], isSide: boolean) => void} onPoint  that was clicked while the clouds are side by side: in the
   *     object's frame, or the frame of the side's platform
   * @throws {Error} where there is no WebGL
   */
  constructor(canvas, onPoint) {
    this.#canvas = canvas;
    this.#onPoint = onPoint;
    this.#renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.#camera.up.set(0, 0, 1);
    this.#scene.add(this.#camera, this.#marks);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.addEventListener('change', () => this.#draw());
    new ResizeObserver(() => this.#resize()).observe(canvas);
    onClick(canvas, (x, y) => this.#click(x, y));
  }

  /** @param {Clouds} clouds */
  load({before_mm, pose_mm}) {
    this.clear();
    this.#clouds = [cloudOf(before_mm, colours[0]), cloudOf(pose_mm, colours[1])];
    this.#scene.add(...this.#clouds);
  }

  /** Gives the GPU's memory back. */
  clear() {
    for (const object of [...this.#clouds, ...this.#marks.children]) {
      object.geometry.dispose();
      object.material.dispose();
      object.removeFromParent();
    }
    this.#clouds = [];
    this.#isBeside = false;
  }

  /** Lays the side over what was seen before. @param {number[][]} object_from_platform  4 x 4, metres */
  showOver(object_from_platform) {
    const isFirst = this.#isBeside || !this.#clouds[1].userData.isPlaced;
    const [x, y, z] = object_from_platform;
    const mm = (/** @type {number[]} */ row) => [row[0], row[1], row[2], 1000 * row[3]];
    this.#isBeside = false;
    this.#place(new Matrix4().set(...mm(x), ...mm(y), ...mm(z), 0, 0, 0, 1), isFirst);
    this.#showMarks([]);
  }

  /** Shows both side by side, each as it stood. @param {number[][]} points_mm  that were clicked, of the one and the other in turn */
  showBeside(points_mm) {
    const [before, side] = this.#clouds.map(({geometry}) => geometry.boundingSphere);
    const distance = (1 + gap) * (before.radius + side.radius);
    const isFirst = !this.#isBeside;
    this.#isBeside = true;
    this.#place(new Matrix4().makeTranslation(before.center.x + distance - side.center.x, before.center.y - side.center.y, 0), isFirst);
    this.#showMarks(points_mm);
  }

  /** @param {Matrix4} matrix  of the side @param {boolean} isFirst  and the eye is to be put where both are seen */
  #place(matrix, isFirst) {
    const side = this.#clouds[1];
    side.matrix.copy(matrix);
    side.updateMatrixWorld(true);
    side.userData.isPlaced = true;
    if (isFirst) {
      this.#aim();
    }
    this.#resize();
  }

  /** @param {number[][]} points_mm */
  #showMarks(points_mm) {
    for (const mark of [...this.#marks.children]) {
      mark.geometry.dispose();
      mark.material.dispose();
      mark.removeFromParent();
    }
    const radius = this.#clouds[0].geometry.boundingSphere.radius / 30;
    points_mm.forEach((point, index) => {
      const mark = markOf(Math.floor(index / 2), radius);
      mark.position.set(...point).applyMatrix4(this.#clouds[index % 2].matrixWorld);
      this.#marks.add(mark);
    });
    this.#draw();
  }

  /** Looks at both clouds. */
  #aim() {
    const balls = this.#clouds.map(({geometry, matrixWorld}) => geometry.boundingSphere.clone().applyMatrix4(matrixWorld));
    const {center, radius} = balls.reduce((all, ball) => all.union(ball), new Sphere().copy(balls[0]));
    this.#resize();
    const from = this.#isBeside ? new Vector3(0, -0.9, 0.43) : sight;
    const {aspect} = this.#camera;
    const reach = this.#isBeside ? Math.max(balls[0].radius, balls[1].radius, radius / aspect) : radius / Math.min(1, aspect);
    const distance = 1.05 * reach / Math.sin(this.#camera.fov / 2 * Math.PI / 180);
    this.#scene.fog = new Fog(darkness, distance - balls[0].radius / 2, distance + 2 * balls[0].radius);
    this.#camera.position.copy(center).addScaledVector(from.clone().normalize(), distance);
    this.#camera.near = distance / 100;
    this.#camera.far = distance * 20;
    this.#camera.updateProjectionMatrix();
    this.#controls.minDistance = distance / 20;
    this.#controls.maxDistance = distance * 4;
    this.#controls.target.copy(center);
    this.#controls.update();
  }

  /** Tells of the point nearest to where somebody clicked; of those in reach, the one nearest to the eye. */
  #click(/** @type {number} */ x, /** @type {number} */ y) {
    if (!this.#isBeside) {
      return;
    }
    const {clientWidth, clientHeight} = this.#canvas;
    const at = new Vector3();
    let best = {depth: Infinity, cloud: -1, index: -1};
    this.#clouds.forEach((cloud, number) => {
      const positions = cloud.geometry.getAttribute('position');
      for (let index = 0; index < positions.count; ++index) {
        at.fromBufferAttribute(positions, index).applyMatrix4(cloud.matrixWorld).project(this.#camera);
        const aside = Math.hypot((at.x + 1) / 2 * clientWidth - x, (1 - at.y) / 2 * clientHeight - y);
        if (aside < reachOfClick && at.z + aside * 1e-4 < best.depth) {
          best = {depth: at.z + aside * 1e-4, cloud: number, index};
        }
      }
    });
    if (best.cloud >= 0) {
      at.fromBufferAttribute(this.#clouds[best.cloud].geometry.getAttribute('position'), best.index);
      this.#onPoint([at.x, at.y, at.z], best.cloud === 1);
    }
  }

  #resize() {
    if (fitToCanvas(this.#renderer, this.#camera, this.#canvas)) {
      this.#draw();
    }
  }

  #draw() {
    if (!this.#isFrameDue && this.#clouds.length > 0) {
      this.#isFrameDue = true;
      requestAnimationFrame(() => {
        this.#isFrameDue = false;
        this.#renderer.render(this.#scene, this.#camera);
      });
    }
  }
}
