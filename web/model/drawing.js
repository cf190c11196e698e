// A drawing on top of a model: points, lines and labels. The labels are HTML, which is sharp at every size.

import {setText} from '../base/dom.js';
import {
  BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial, Vector3,
} from '../three.js';

/** @typedef {import('./measure.js').Drawing} Drawing */

const colour = 0xf4c95d;
const dot = 11;  // pixels
const margin = 16;  // pixels

/** @param {number[][]} points */
function geometryOf(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flat()), 3));
  return geometry;
}

/** @param {Drawing} drawing @returns {Group} */
export function drawingMark({points = [], lines = []}) {
  const mark = new Group();
  const pieces = lines.flatMap((line) => line.slice(1).flatMap((point, i) => [line[i], point]));
  mark.add(
      new Points(geometryOf(points), new PointsMaterial({color: colour, size: dot, sizeAttenuation: false})),
      new LineSegments(geometryOf(pieces), new LineBasicMaterial({color: colour})));
  mark.children.forEach((/** @type {any} */ child) => {
    child.renderOrder = 1;  // on top of the model
    child.material.depthTest = false;
    child.frustumCulled = false;
  });
  return mark;
}

/** The labels of a drawing. */
export class Labels {
  #parent;
  /** @type {{element: HTMLElement, at: Vector3}[]} */
  #shown = [];

  /** @param {HTMLElement} parent  over the canvas */
  constructor(parent) {
    this.#parent = parent;
  }

  /** @param {NonNullable<Drawing['labels']>} labels  in place of those before */
  show(labels) {
    this.#shown = labels.map(({at, words}) => {
      const element = document.createElement('span');
      setText(element, words);
      return {element, at: new Vector3(...at)};
    });
    this.#parent.replaceChildren(...this.#shown.map(({element}) => element));
  }

  /** Moves each label to where the camera sees its place. @param {any} camera @param {HTMLCanvasElement} canvas */
  place(camera, {clientWidth, clientHeight}) {
    for (const {element, at} of this.#shown) {
      const {x, y, z} = at.clone().project(camera);
      element.hidden = z > 1;  // behind the camera
      element.style.left = `${Math.min((0.5 + 0.5 * x) * clientWidth, clientWidth - element.offsetWidth - margin)}px`;
      element.style.top = `${(0.5 - 0.5 * y) * clientHeight}px`;
    }
  }
}
