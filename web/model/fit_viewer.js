// Two point clouds in 3D: one laid over the other, or side by side to set pairs of points.

import {Fog, Group, Matrix4, Mesh, MeshBasicMaterial, OrbitControls, Scene, SphereGeometry, WebGLRenderer} from '../three.js';
import {fitToCanvas, onClick} from '../base/canvas.js';
import {besides, cloudOf, lookAt, makeEye, pointAt} from './fit_clouds.js';

/** @typedef {{before_mm: number[][], pose_mm: number[][]}} Clouds */

const colours = [0x35c4bd, 0xf09a3e];  // seen before, and the side
const pairColours = [0xff5c8a, 0xffe14d, 0x9b8cff];
const darkness = 0x14272f;  // fog colour of far points

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
  #camera = makeEye();
  #scene = new Scene();
  #controls;
  #marks = new Group();
  /** @type {any[]} what was seen before, and the side */
  #clouds = [];
  #isBeside = false;
  #isFrameDue = false;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {(point_mm: number[], isSide: boolean) => void} onPoint  a point clicked while the clouds are side by side, in the
   *     object's frame or in the side's platform frame
   * @throws {Error} where there is no WebGL
   */
  constructor(canvas, onPoint) {
    this.#canvas = canvas;
    this.#onPoint = onPoint;
    this.#renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
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

  /** Frees GPU memory. */
  clear() {
    for (const object of [...this.#clouds, ...this.#marks.children]) {
      object.geometry.dispose();
      object.material.dispose();
      object.removeFromParent();
    }
    this.#clouds = [];
    this.#isBeside = false;
  }

  /** Lays the side over the points seen before. @param {number[][]} object_from_platform  4 x 4, metres */
  showOver(object_from_platform) {
    const isFirst = this.#isBeside || !this.#clouds[1].userData.isPlaced;
    const [x, y, z] = object_from_platform;
    const mm = (/** @type {number[]} */ row) => [row[0], row[1], row[2], 1000 * row[3]];
    this.#isBeside = false;
    this.#place(new Matrix4().set(...mm(x), ...mm(y), ...mm(z), 0, 0, 0, 1), isFirst);
    this.#showMarks([]);
  }

  /** Shows both clouds side by side, each as it stood. @param {number[][]} points_mm  clicked points, alternately of each cloud */
  showBeside(points_mm) {
    const isFirst = !this.#isBeside;
    this.#isBeside = true;
    this.#place(besides(this.#clouds), isFirst);
    this.#showMarks(points_mm);
  }

  /** @param {Matrix4} matrix  of the side @param {boolean} isFirst  whether to aim the camera at both */
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

  /** Aims the camera at both clouds. */
  #aim() {
    this.#resize();
    const {middle, distance, depth} = lookAt(this.#camera, this.#clouds, this.#isBeside);
    this.#scene.fog = new Fog(darkness, distance - depth / 2, distance + 2 * depth);
    this.#controls.minDistance = distance / 20;
    this.#controls.maxDistance = distance * 4;
    this.#controls.target.copy(middle);
    this.#controls.update();
  }

  /** Reports the clicked point. */
  #click(/** @type {number} */ x, /** @type {number} */ y) {
    const found = this.#isBeside ? pointAt(this.#clouds, this.#camera, this.#canvas, x, y) : null;
    if (found) {
      this.#onPoint(found.point_mm, found.cloud === 1);
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
