// The model in 3D, in millimetres, Z up, standing on a drawing of the platform.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, Color, DirectionalLight, Group, HemisphereLight, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, MeshStandardMaterial, OrbitControls, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer,
} from './three.js';
import {fitToCanvas} from './canvas.js';
import {ballOf, placesMark} from './places_mark.js';

/** @typedef {import('./stl.js').Mesh} StlMesh */

const clay = 0xd8d2c4;
const edgeColour = new Color(0x0e5a66);
const filledColour = new Color(0xd9913f);
const ringStep = 50;   // millimetres between the platform's rings
const keyTurn = Math.PI / 24;  // radians
const firstSight = new Vector3(0.42, -0.83, 0.37);  // from the model to the eye

/**
 * Flat-shaded clay that can show its triangles. Each triangle has its own three vertices, in order, so that a vertex's number
 * tells its corner, and a pixel's distance from the nearest side comes from interpolating the corners: no further buffers.
 * @param {{edges: {value: number}, filled: {value: number}}} strengths  of the edges, and of the colour of what was filled in: 0 hides them
 */
function clayMaterial({edges, filled}) {
  const material = new MeshStandardMaterial({color: clay, roughness: 0.78, metalness: 0, flatShading: true});
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {
      edgeStrength: edges, edgeColour: {value: edgeColour}, filledStrength: filled, filledColour: {value: filledColour},
    });
    shader.vertexShader = `attribute float filled;\nvarying float vFilled;\nvarying vec3 vCorner;\n${shader.vertexShader}`
        .replace('void main() {', `void main() {
      vFilled = filled;
      int corner = gl_VertexID % 3;
      vCorner = vec3(corner == 0, corner == 1, corner == 2);`);
    shader.fragmentShader = `varying vec3 vCorner;
varying float vFilled;
uniform float edgeStrength;
uniform vec3 edgeColour;
uniform float filledStrength;
uniform vec3 filledColour;
${shader.fragmentShader}`
        .replace('#include <color_fragment>', `#include <color_fragment>
      diffuseColor.rgb = mix(diffuseColor.rgb, filledColour, vFilled * filledStrength);`)
        .replace('#include <opaque_fragment>', `
      vec3 perPixel = fwidth(vCorner);
      vec3 inside = smoothstep(perPixel * 0.4, perPixel * 1.4, vCorner);
      float edge = 1.0 - min(min(inside.x, inside.y), inside.z);
      float widest = max(max(perPixel.x, perPixel.y), perPixel.z);
      outgoingLight = mix(outgoingLight, edgeColour, edge * edgeStrength * (1.0 - smoothstep(0.5, 1.0, widest)));
      #include <opaque_fragment>`);
  };
  return material;
}

/** @param {number} radius @returns {number[]} line segments of rings and two axes on the platform's surface */
function platformLines(radius) {
  const sides = 96;
  const lines = [-radius, 0, 0, radius, 0, 0, 0, -radius, 0, 0, radius, 0];
  for (let ring = ringStep; ring <= radius; ring += ringStep) {
    for (let i = 0; i < sides; ++i) {
      for (const at of [i, i + 1]) {
        const angle = 2 * Math.PI * at / sides;
        lines.push(ring * Math.cos(angle), ring * Math.sin(angle), 0);
      }
    }
  }
  return lines;
}

/** @param {number} radius  of the drawn platform, millimetres */
function platform(radius) {
  const lines = new BufferGeometry();
  lines.setAttribute('position', new BufferAttribute(new Float32Array(platformLines(radius)), 3));
  const disc = new Mesh(new CircleGeometry(radius, 96),
      new MeshBasicMaterial({color: 0x5fb8b5, transparent: true, opacity: 0.07, depthWrite: false, side: 2}));
  const grid = new LineSegments(lines, new LineBasicMaterial({color: 0x7fc4c4, transparent: true, opacity: 0.28}));
  grid.add(disc);
  return grid;
}

export class Viewer {
  #canvas;
  #onTurning;
  #renderer;
  #camera = new PerspectiveCamera(32);
  #scene = new Scene();
  #edges = {value: 0};
  #filled = {value: 0};
  #controls;
  #subject = new Group();  // the model and the platform below it
  /** @type {any} */
  #model = null;
  /** @type {any} */
  #places = null;
  #isAimed = false;  // by hand
  #isFrameDue = false;
  #drawnAt = 0;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {{onTurning: (isTurning: boolean) => void, onLost: () => void}} events
   * @throws {Error} where there is no WebGL
   */
  constructor(canvas, {onTurning, onLost}) {
    this.#canvas = canvas;
    this.#onTurning = onTurning;
    this.#renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.#camera.up.set(0, 0, 1);
    this.#scene.add(new HemisphereLight(0xeaf6f8, 0x33434b, 1.5), this.#camera, this.#subject);
    this.#lights();
    this.#controls = new OrbitControls(this.#camera, canvas);
    canvas.style.touchAction = 'pan-y';  // a finger that goes up or down scrolls the page, which may be no wider than the picture
    this.#controls.enableDamping = true;
    this.#controls.autoRotateSpeed = 1.6;
    this.#controls.addEventListener('change', () => this.#draw());
    this.#controls.addEventListener('start', () => {
      this.#isAimed = true;
      this.turn(false);
    });
    new ResizeObserver(() => this.#resize()).observe(canvas);
    canvas.addEventListener('webglcontextlost', onLost);
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  /** The light comes from beside the eye, so that a shape reads from every side. */
  #lights() {
    const key = new DirectionalLight(0xfff6e8, 2.1);
    key.position.set(-0.5, 0.8, 1);
    const rim = new DirectionalLight(0x7fe3dd, 1.1);
    rim.position.set(1, 0.35, -0.8);
    for (const light of [key, rim]) {
      light.target = this.#camera;
      this.#camera.add(light);
    }
  }

  /**
   * @param {StlMesh} mesh  its positions are given away: they live on in the GPU only
   * @param {{isFirst?: boolean}} [growth]  a mesh that is not the first of its object leaves the eye where somebody put it
   */
  show({positions, filled, min, max}, {isFirst = true} = {}) {
    const isTurning = this.#controls.autoRotate;
    this.clear();
    const geometry = new BufferGeometry();
    const attribute = new BufferAttribute(positions, 3);
    attribute.onUpload(() => {
      attribute.array = /** @type {any} */ (null);
    });
    geometry.setAttribute('position', attribute);
    if (filled) {  // where it is missing, WebGL reads 0
      geometry.setAttribute('filled', new BufferAttribute(filled, 1, true));
    }
    const middle = new Vector3(...min).add(new Vector3(...max)).divideScalar(2);
    geometry.boundingSphere = new Sphere(middle, new Vector3(...max).distanceTo(middle));  // it cannot be computed later
    this.#model = new Mesh(geometry, clayMaterial({edges: this.#edges, filled: this.#filled}));
    const reach = Math.hypot(Math.max(-min[0], max[0]), Math.max(-min[1], max[1]));
    this.#subject.add(this.#model, platform(Math.max(3, Math.ceil(reach / ringStep)) * ringStep));
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

  /** Gives the GPU's memory back. */
  clear() {
    this.#subject.traverse((/** @type {any} */ object) => {
      object.geometry?.dispose();
      object.material?.dispose();
    });
    this.#subject.clear();
    this.#model = null;
    this.#places = null;
    this.turn(false);
  }

  /** Looks at the whole model, a little from above, from where the sensor stands. */
  reset() {
    if (this.#model) {
      this.#isAimed = false;
      this.#aim(firstSight);
    }
  }

  /** Marks places of the model, and looks at them. @param {number[][]} points_mm  none: marks nothing */
  showPlaces(points_mm) {
    this.#places?.geometry.dispose();
    this.#places?.material.dispose();
    this.#places?.removeFromParent();
    this.#places = null;
    if (this.#model && points_mm.length > 0) {
      this.#places = placesMark(points_mm);
      this.#subject.add(this.#places);
      const {center, radius} = this.#model.geometry.boundingSphere;
      const ball = ballOf(points_mm);
      const outwards = ball.center.clone().sub(center);
      const sight = outwards.length() > radius / 20 ? outwards.normalize().setZ(Math.max(outwards.z, 0.25)).normalize() : firstSight;
      this.#isAimed = true;
      this.turn(false);
      this.#aim(sight, {center: ball.center, radius: Math.max(1.4 * ball.radius, radius / 2)});
    }
    this.#draw();
  }

  /** Looks at the whole model, or at a ball. @param {Vector3} sight  from it to the eye, of length 1 */
  #aim(sight, {center, radius} = this.#model.geometry.boundingSphere) {
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

  /** @param {boolean} isTurning  by itself */
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

  /** @param {boolean} isShown  by a colour of its own */
  showFilled(isShown) {
    this.#filled.value = isShown ? 0.85 : 0;
    this.#draw();
  }

  #resize() {
    if (fitToCanvas(this.#renderer, this.#camera, this.#canvas)) {
      this.#draw();
    }
  }

  /** Draws in the next frame, and goes on for as long as something moves. */
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
        this.#controls.update(seconds);  // which asks for the next frame if it moves the camera
        this.#renderer.render(this.#scene, this.#camera);
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
