// The form of the scanned space: dragged in the plans and in the live picture, or typed, and saved as the scanner's setting.

import {cursorOf, edgesAt, withSide} from './clip_edges.js';
import {draggedTo, handlesOf} from './clip_handles.js';
import {element, show} from '../base/dom.js';
import {plansShown, rigShown} from './pose_picture.js';
import {text} from '../base/texts.js';

const reach = {mouse: 7, pen: 10, touch: 16};  // picking distance, pixels

/** @type {number[] | null} in force */
let inForce = null;
/** @type {number[] | null} as dragged or typed; null: unchanged */
let draft = null;
/** @type {(clip_mm: number[], isDragged: boolean) => void} */
let onSpace = () => {};

const fields = () => /** @type {HTMLInputElement[]} */ ([...element('space').querySelectorAll('input')])
    .sort((a, b) => Number(a.dataset.clip) - Number(b.dataset.clip));

const isEmpty = (/** @type {number[]} */ clip_mm) => [0, 1, 2].some((axis) => clip_mm[axis] >= clip_mm[axis + 3]);

function fill() {
  const space = draft ?? inForce;
  if (space) {
    fields().forEach((field, index) => {
      if (document.activeElement !== field) {
        field.value = String(space[index]);
      }
    });
  }
  show(element('space-kept'), draft !== null);
}

/** @param {number[]} clip_mm @param {boolean} isDragged */
function set(clip_mm, isDragged) {
  draft = clip_mm;
  fill();
  onSpace(clip_mm, isDragged);
}

/** Discards unsaved changes. */
export function discardSpace() {
  draft = null;
  fields().forEach((field) => field.setCustomValidity(''));
  fill();
  if (inForce) {
    onSpace(inForce, false);
  }
}

/** @returns {number[] | null} the space as dragged or typed; null: unchanged */
export const chosenSpace = () => draft;

/** Shows the space in force unless there are unsaved changes. @param {number[]} clip_mm */
export function showSpace(clip_mm) {
  inForce = clip_mm;
  if (!draft) {
    fill();
    onSpace(clip_mm, false);
  }
}

/** Reads the fields, and marks those that leave no space as invalid. */
function type() {
  const typed = fields().map((field) => field.valueAsNumber);
  fields().forEach((field, index) => field.setCustomValidity(
      index > 2 && typed[index] <= typed[index - 3] ? text('clip.empty') : ''));
  if (typed.every(Number.isFinite) && !isEmpty(typed)) {
    set(typed, false);
  }
}

/** Lets a pointer drag the sides of the space in one plan. @param {ReturnType<typeof plansShown>[number]} shown */
function makeDraggable({canvas, side, planNow}) {
  /** @type {number[]} */
  let held = [];
  const at = (/** @type {PointerEvent | Touch} */ {clientX, clientY}, /** @type {number} */ distance) => {
    const {left, top} = canvas.getBoundingClientRect();
    const space = draft ?? inForce;
    const plan = planNow();
    const [x, y] = [clientX - left, clientY - top];
    return {plan, x, y, edges: space && plan ? edgesAt(plan, side, space, x, y, distance) : []};
  };
  canvas.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => {
    held = at(event, reach[/** @type {keyof typeof reach} */ (event.pointerType)] ?? reach.mouse).edges;
    if (held.length > 0) {
      canvas.setPointerCapture(event.pointerId);
    }
  });
  canvas.addEventListener('pointermove', (/** @type {PointerEvent} */ event) => {
    const {plan, x, y, edges} = at(event, reach.mouse);
    const space = draft ?? inForce;
    if (held.length === 0 || !plan || !space) {
      canvas.style.cursor = cursorOf(edges, side);
      return;
    }
    const [right, up] = plan.toMillimetres(x, y);
    set(held.reduce((clip_mm, index) => withSide(clip_mm, index, index % 3 === side.right ? right : up), space), true);
  });
  for (const end of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(end, () => {
      if (held.length > 0 && draft) {
        onSpace(draft, false);
      }
      held = [];
    });
  }
  // A finger on a side drags it; anywhere else it scrolls the page.
  canvas.addEventListener('touchstart', (/** @type {TouchEvent} */ event) => {
    if (at(event.touches[0], reach.touch).edges.length > 0) {
      event.preventDefault();
    }
  }, {passive: false});
}

/** Lets a pointer drag the handles of the space in the live picture. */
function makeHandlesDraggable() {
  const overlay = element('overlay');
  /** @type {{rig: NonNullable<ReturnType<typeof rigShown>>, handle: import('./clip_handles.js').Handle} | null} */
  let held = null;
  overlay.addEventListener('pointerdown', (/** @type {any} */ event) => {
    const rig = rigShown();
    const handle = rig && handlesOf(rig).find(({index}) => String(index) === event.target.dataset.side);
    held = rig && handle ? {rig, handle} : null;
    if (held) {
      event.target.setPointerCapture(event.pointerId);
    }
  });
  overlay.addEventListener('pointermove', (/** @type {PointerEvent} */ event) => {
    const space = draft ?? inForce;
    if (held && space) {
      const {left, top, width, height} = overlay.getBoundingClientRect();
      const {rig, handle} = held;
      const value = draggedTo(rig, handle, (event.clientX - left) / width * rig.sensor.width, (event.clientY - top) / height * rig.sensor.height);
      value !== null && set(withSide(space, handle.index, value), true);
    }
  });
  for (const end of ['pointerup', 'pointercancel']) {
    overlay.addEventListener(end, () => {
      if (held && draft) {
        onSpace(draft, false);
      }
      held = null;
    });
  }
}

/** @param {{onChange: (clip_mm: number[], isDragged: boolean) => void, onKeep: () => void}} events */
export function prepareSpace({onChange, onKeep}) {
  onSpace = onChange;
  plansShown().forEach(makeDraggable);
  makeHandlesDraggable();
  const form = element('space');
  form.addEventListener('input', type);
  element('space-discard').addEventListener('click', discardSpace);
  form.addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    onKeep();
  });
}
