// The 3D view of a model in millimetres, Z up, on a drawing of the platform.

import {
  ACESFilmicToneMapping, BufferAttribute, BufferGeometry, Group, Mesh, OrbitControls, PerspectiveCamera, Scene, Sphere,
  Vector3, WebGLRenderer,
} from '../three.js';
import {fitToCanvas, onClick} from '../base/canvas.js';
import {clayMaterial, lampLight, platform, ringStep, roomLight, uncut} from './clay.js';
import {drawingMark, Labels} from './drawing.js';
import {erasedMark} from './erased_mark.js';
import {lightOf} from './light.js';
import {smoothNormals} from './normals.js';
import {placeAt} from './pick.js';
import {ballOf, placesMark} from './places_mark.js';
import {restingSide} from './resting_pose.js';
import {boxOf, extents} from './section.js';
import {Shadow} from './shadow.js';

/** @typedef {import('./stl.js').Mesh} StlMesh */

const maxSmooth = 200_000;  // triangles; those of a larger model are small enough as they are
const keyTurn = Math.PI / 24;  // radians
const hatchLines = 24;  // of a section, on half the model's diagonal
const down = new Vector3(0, 0, -1);
const world = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const samplesKept = 5000;  // sampled vertices, from which the pose and the height range of a model on another side are computed
const firstSight = new Vector3(0.42, -0.83, 0.37);  // initial direction from the model to the camera

export class Viewer {
  #canvas;
  #onTurning;
  #onPlace;
  #renderer;
  #camera = new PerspectiveCamera(32);
  #scene = new Scene();
  #edges = {value: 0};
  #filled = {value: 0};
  #painted = {value: 0};
  #cut = {value: uncut};
  #hatch = {value: 1};  // millimetres between the lines of a section
  #shaded = {value: 1};
  #shadow = new Shadow();
  #reach = 0;  // of the shadow's texture, millimetres
  /** @type {import('./measure.js').Box} around the model in its current pose, millimetres */
  #box = {min: [0, 0, 0], max: [0, 0, 0]};
  #uprightBox = this.#box;
  /** @type {Vector3[]} */
  #samples = [];
  #controls;
  #subject = new Group();  // the model and the platform below it
  /** @type {any} */
  #model = null;
  /** @type {any} a simpler mesh of a large model, drawn while it turns */
  #coarse = null;
  #isCoarse = false;  // whether the model itself is such a mesh, whose successor may need it
  /** @type {any} */
  #places = null;
  /** @type {any} */
  #drawing = null;
  #labels;
  /** @type {any} */
  #erased = null;
  #isAimed = false;  // whether the user has moved the camera
  #isFrameDue = false;
  #drawnAt = 0;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {HTMLElement} labels  over the canvas, for the labels of a drawing
   * @param {{onTurning: (isTurning: boolean) => void, onLost: () => void, onPlace: (place_mm: number[]) => void}} events
   *     onPlace: called for a click on the model
   * @throws {Error} where there is no WebGL
   */
  constructor(canvas, labels, {onTurning, onLost, onPlace}) {
    this.#canvas = canvas;
    this.#labels = new Labels(labels);
    this.#onTurning = onTurning;
    this.#onPlace = onPlace;
    this.#renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.#camera.up.set(0, 0, 1);
    this.#renderer.toneMapping = ACESFilmicToneMapping;
    this.#scene.add(roomLight(), lampLight(), this.#camera, this.#subject);
    this.#controls = new OrbitControls(this.#camera, canvas);
    canvas.style.touchAction = 'pan-y';  // a vertical swipe scrolls the page, as the picture may be as wide as the page
    this.#controls.enableDamping = true;
    this.#controls.autoRotateSpeed = 1.6;
    this.#controls.addEventListener('change', () => this.#draw());
    this.#controls.addEventListener('start', () => {
      this.#isAimed = true;
      this.turn(false);
      this.#simplify(true);
    });
    this.#controls.addEventListener('end', () => this.#simplify(false));
    new ResizeObserver(() => this.#resize()).observe(canvas);
    canvas.addEventListener('webglcontextlost', onLost);
    canvas.addEventListener('keydown', (event) => this.#key(event));
    onClick(canvas, (x, y) => this.#pick(x, y));
  }

  /** @param {number} x @param {number} y  of the canvas, CSS pixels */
  #pick(x, y) {
    this.#simplify(false);
    const place = this.#model && placeAt(this.#renderer, this.#camera, this.#model, this.#cut.value, x, y);
    place && this.#onPlace(place);
  }

  /**
   * @param {StlMesh} mesh  its positions are moved to the GPU and not kept in memory
   * @param {{isFirst?: boolean, isGrowing?: boolean, isCoarse?: boolean}} [growth]  isFirst: false keeps the user's
   *     camera, for a further mesh of the same object; isGrowing: it is replaced soon, and shaded flat; isCoarse: the
   *     whole model follows, and if it is large, this mesh is drawn while it turns
   */
  show({positions, filled, min, max}, {isFirst = true, isGrowing = false, isCoarse = false} = {}) {
    const isTurning = this.#controls.autoRotate;
    const isLarge = positions.length > 9 * maxSmooth;
    const before = !isFirst && this.#isCoarse && isLarge ? this.#model : null;
    before?.removeFromParent();
    this.clear();
    this.#coarse = before;
    this.#isCoarse = isCoarse;
    const geometry = new BufferGeometry();
    const isSmooth = !isGrowing && !isLarge;
    const attribute = new BufferAttribute(positions, 3);
    attribute.onUpload(() => {
      attribute.array = /** @type {any} */ (null);
    });
    geometry.setAttribute('position', attribute);
    if (filled) {  // without the attribute, WebGL reads 0
      geometry.setAttribute('filled', new BufferAttribute(filled, 1, true));
    }
    const middle = new Vector3(...min).add(new Vector3(...max)).divideScalar(2);
    const radius = new Vector3(...max).distanceTo(middle);
    geometry.boundingSphere = new Sphere(middle, radius);  // cannot be computed later, without the positions
    if (isSmooth) {
      const normals = smoothNormals(positions);
      geometry.setAttribute('normal', new BufferAttribute(normals, 3, true));
      const light = lightOf(positions, normals, {center: middle.toArray(), radius});
      geometry.setAttribute('light', new BufferAttribute(light, 2, true));
    }
    this.#model = new Mesh(geometry, clayMaterial({
      edges: this.#edges, filled: this.#filled, painted: this.#painted, cut: this.#cut, hatch: this.#hatch,
      shaded: this.#shaded, isSmooth,
    }));
    this.#uprightBox = this.#box = {min, max};
    this.#hatch.value = radius / hatchLines;
    const corners = positions.length / 3;
    this.#samples = Array.from({length: Math.min(corners, samplesKept)}, (_, i) =>
      new Vector3().fromArray(positions, 3 * Math.floor(i * corners / Math.min(corners, samplesKept))));
    const reach = Math.hypot(Math.max(-min[0], max[0]), Math.max(-min[1], max[1]));
    this.#reach = 2 * reach + 1.3 * Math.max(0, max[2]);  // the lamp's rays lie flatter than 45 degrees
    const rings = Math.max(3, Math.ceil(reach / ringStep));
    this.#subject.add(this.#model, platform(rings * ringStep, this.#shadow.texture, this.#reach));
    if (this.#coarse) {
      this.#coarse.visible = false;
      this.#subject.add(this.#coarse);
    }
    this.#castShadow(isGrowing);
    this.#resize();
    if (isFirst) {
      this.reset();
      return;
    }
    this.turn(isTurning);
    if (!this.#isAimed) {
      this.#aim(this.#camera.position.clone().sub(this.#controls.target).normalize());
    }
  }

  /** Frees GPU memory. */
  clear() {
    this.#subject.traverse((/** @type {any} */ object) => {
      object.geometry?.dispose();
      object.material?.dispose();
    });
    this.#subject.clear();
    this.#model = null;
    this.#coarse = null;
    this.#isCoarse = false;
    this.#shaded.value = 1;
    this.#places = null;
    this.#erased = null;
    this.showDrawing(null);
    this.#painted.value = 0;
    this.turn(false);
  }

  /** Aims the camera at the whole model, from the sensor's side and slightly above. */
  reset() {
    if (this.#model) {
      this.#isAimed = false;
      this.#aim(firstSight);
    }
  }

  /** Rotates the model so that it rests on the side that has a place. @param {number[] | null} place_mm  null: as scanned */
  lay(place_mm) {
    const {quaternion, position} = this.#model;
    if (place_mm) {
      quaternion.setFromUnitVectors(restingSide(this.#samples, this.#model.worldToLocal(new Vector3(...place_mm))), down);
      const {x, y} = this.#model.geometry.boundingSphere.center.clone().applyQuaternion(quaternion);
      const samples = this.#samples.flatMap((sample) => sample.toArray());
      position.set(-x, -y, -extents(samples, this.pose().axes).min[2]);
      this.#box = boxOf(samples, this.pose());
    } else {
      quaternion.identity();
      position.setScalar(0);
      this.#box = this.#uprightBox;
    }
    this.#model.updateMatrixWorld();
    this.#coarse?.quaternion.copy(quaternion);
    this.#coarse?.position.copy(position);
    this.#shaded.value = place_mm ? 0 : 1;
    this.#castShadow();
    this.showPlaces([]);
    this.reset();
  }

  /** Marks places of the model, and aims the camera at them. @param {number[][]} points_mm  empty: removes the marks */
  showPlaces(points_mm) {
    this.#places?.geometry.dispose();
    this.#places?.material.dispose();
    this.#places?.removeFromParent();
    this.#places = null;
    if (this.#model && points_mm.length > 0) {
      this.#places = placesMark(points_mm);
      this.#subject.add(this.#places);
      this.#places.applyMatrix4(this.#model.matrixWorld);
      const {center, radius} = this.#ball();
      const ball = ballOf(points_mm).applyMatrix4(this.#model.matrixWorld);
      const outwards = ball.center.clone().sub(center);
      const sight = outwards.length() > radius / 20 ? outwards.normalize().setZ(Math.max(outwards.z, 0.25)).normalize() : firstSight;
      this.#isAimed = true;
      this.turn(false);
      this.#aim(sight, {center: ball.center, radius: Math.max(1.4 * ball.radius, radius / 2)});
    }
    this.#draw();
  }

  /** Draws on top of the model. @param {import('./measure.js').Drawing | null} drawing  null: nothing */
  showDrawing(drawing) {
    this.#labels.show(drawing?.labels ?? []);
    this.#drawing = this.#replaced(this.#drawing, drawing && drawingMark(drawing), this.#subject);
  }

  /** Marks balls that will be erased. @param {number[][]} balls_mm  centre and radius, in the model's own frame */
  showErased(balls_mm) {
    this.#erased = this.#replaced(this.#erased, balls_mm.length > 0 ? erasedMark(balls_mm) : null, this.#subject);
    this.#erased?.applyMatrix4(this.#model.matrixWorld);
  }

  /** A mark in place of another. @param {any} before @param {any} mark @param {any} parent */
  #replaced(before, mark, parent) {
    before?.traverse((/** @type {any} */ object) => {
      object.geometry?.dispose();
      object.material?.dispose();
    });
    before?.removeFromParent();
    mark && parent.add(mark);
    this.#draw();
    return mark;
  }

  /** @returns {import('./section.js').Pose} of the model */
  pose() {
    const back = this.#model.quaternion.clone().invert();
    return {
      axes: world.map((axis) => new Vector3(...axis).applyQuaternion(back).toArray()),
      origin: this.#model.position.toArray(),
    };
  }

  /** Around the model in its pose; on another side, around a sample of its corners. */
  get box() {
    return this.#box;
  }

  /** A place in the frame of the model. @param {number[]} place_mm  in view */
  inModel(place_mm) {
    return this.#model.worldToLocal(new Vector3(...place_mm)).toArray();
  }

  /** Cuts off what lies beyond a plane of the view. @param {import('./section.js').Plane | null} plane  null: no cut */
  cut(plane) {
    this.#cut.value = plane ? [...plane.normal, plane.distance] : uncut;
    this.#draw();
  }

  /** Draws the shadow of the model in its current pose. @param {boolean} [isBrief]  whether it is soon drawn again */
  #castShadow(isBrief = false) {
    this.#model.updateMatrixWorld();
    this.#shadow.draw(this.#renderer, this.#coarse ?? this.#model, this.#model.matrixWorld, this.#reach, isBrief);
  }

  /** Shows the coarse mesh of a large model, which has no colours, while it is dragged. @param {boolean} isDragged */
  #simplify(isDragged) {
    if (this.#coarse) {
      this.#coarse.visible = isDragged && !this.#painted.value;
      this.#model.visible = !this.#coarse.visible;
      this.#draw();
    }
  }

  /** The bounding sphere of the model in its current pose. */
  #ball() {
    return this.#model.geometry.boundingSphere.clone().applyMatrix4(this.#model.matrixWorld);
  }

  /** Aims the camera at a sphere, by default around the whole model. @param {Vector3} sight  unit vector from it to the camera */
  #aim(sight, {center, radius} = this.#ball()) {
    const narrow = Math.min(1, this.#camera.aspect);
    const distance = 1.05 * radius / (Math.sin(this.#camera.fov / 2 * Math.PI / 180) * narrow);
    this.#camera.position.copy(center).addScaledVector(sight, distance);
    this.#camera.near = distance / 100;
    this.#camera.far = distance * 20;
    this.#camera.updateProjectionMatrix();
    this.#controls.minDistance = distance / 20;
    this.#controls.maxDistance = distance * 4;
    this.#controls.target.copy(center);
    this.#controls.update();
    this.#draw();
  }

  /** @param {boolean} isTurning  whether the camera rotates automatically */
  turn(isTurning) {
    if (this.#controls.autoRotate !== isTurning) {
      this.#controls.autoRotate = isTurning;
      this.#onTurning(isTurning);
    }
    this.#draw();
  }

  /** @param {boolean} areShown */
  showEdges(areShown) {
    this.#edges.value = areShown ? 0.75 : 0;
    this.#draw();
  }

  /** @param {boolean} isShown  whether filled-in surface has its own colour */
  showFilled(isShown) {
    this.#filled.value = isShown ? 0.85 : 0;
    this.#draw();
  }

  /** @param {Uint8Array | null} colours  red, green and blue of each corner of the shown model; null: clay */
  paint(colours) {
    const geometry = this.#model?.geometry;
    this.#painted.value = colours && colours.length === 3 * geometry?.attributes.position.count ? 1 : 0;
    this.#painted.value && geometry.setAttribute('paint', new BufferAttribute(colours, 3, true));
    this.#draw();
  }

  /** The picture as it is now, as the address of a PNG. */
  picture() {
    this.#renderer.render(this.#scene, this.#camera);
    return this.#canvas.toDataURL();
  }

  #resize() {
    if (fitToCanvas(this.#renderer, this.#camera, this.#canvas)) {
      this.#draw();
    }
  }

  /** Draws in the next animation frame, and continues as long as something moves. */
  #draw() {
    if (this.#isFrameDue || !this.#model) {
      return;
    }
    this.#isFrameDue = true;
    requestAnimationFrame((now) => {
      this.#isFrameDue = false;
      const seconds = Math.min((now - this.#drawnAt) / 1000, 0.1);
      this.#drawnAt = now;
      if (this.#canvas.clientWidth > 0 && this.#model) {
        this.#controls.update(seconds);  // requests the next frame if it moves the camera
        this.#renderer.render(this.#scene, this.#camera);
        this.#labels.place(this.#camera, this.#canvas);
      }
    });
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    /** @type {Record<string, () => void>} */
    const moves = {
      ArrowLeft: () => this.#controls.rotateLeft(keyTurn),
      ArrowRight: () => this.#controls.rotateLeft(-keyTurn),
      ArrowUp: () => this.#controls.rotateUp(keyTurn),
      ArrowDown: () => this.#controls.rotateUp(-keyTurn),
      '+': () => this.#controls.dollyIn(0.9),
      '-': () => this.#controls.dollyOut(0.9),
    };
    if (event.key === 'Enter') {
      this.#pick(this.#canvas.clientWidth / 2, this.#canvas.clientHeight / 2);
    }
    const move = moves[event.key];
    if (move && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      this.#isAimed = true;
      this.turn(false);
      move();
      this.#draw();
    }
  }
}
