// The live depth picture with the rig drawn in by a pose, the distance under the pointer, and the readings from the side
// and from above.

import {handlesOf} from './clip_handles.js';
import {distanceOf, distanceText, drawDepth} from './depth.js';
import {element, part, setText, show} from './dom.js';
import {overlayOf} from './overlay.js';
import {drawPlan, fromAbove, fromSide, placed, planOf} from './plans.js';

/** @typedef {import('./pose.js').Matrix} Matrix */

export const radius_mm = 150;  // of the platform

const plans = /** @type {const} */ ([['plan-side', fromSide], ['plan-above', fromAbove]]);

/** @type {Map<string, import('./plans.js').Plan>} as drawn */
const drawnPlans = new Map();
let arePlansHeld = false;  // while something is dragged in them

/** @type {{pose: Matrix | null, clip_mm: number[], seen: import('./api_calibration.js').Points | null}} */
const shown = {pose: null, clip_mm: [-140, -140, 5, 140, 140, 400], seen: null};

/** @type {Uint8Array | null} brightness of the picture that is shown */
let picture = null;
/** @type {[number, number] | null} pixel of the picture that is pointed at */
let pointed = null;
let isDue = false;

/** What the live picture shows: a pose, what looks from there, and the space; null before there is a picture. */
export const rigShown = () => shown.pose && shown.seen ? {pose: shown.pose, sensor: shown.seen.sensor, clip_mm: shown.clip_mm} : null;

function drawHandles() {
  const rig = rigShown();
  const handles = rig ? handlesOf(rig) : [];
  for (const circle of element('overlay').querySelectorAll('circle')) {
    const handle = handles.find(({index}) => index === Number(circle.dataset.side));
    show(circle, handle !== undefined);
    circle.setAttribute('cx', String(handle?.x ?? 0));
    circle.setAttribute('cy', String(handle?.y ?? 0));
  }
}

function drawOverlay() {
  if (shown.pose && shown.seen) {
    const {sensor} = shown.seen;
    element('overlay').setAttribute('viewBox', `0 0 ${sensor.width} ${sensor.height}`);
    for (const [line, path] of Object.entries(overlayOf({pose: shown.pose, sensor, clip_mm: shown.clip_mm, radius_mm}))) {
      part(element('overlay'), `[data-line=${line}]`).setAttribute('d', path);
    }
    drawHandles();
  }
}

function drawPlans() {
  const points = shown.pose && shown.seen ? placed(shown.pose, shown.seen.points_mm) : [];
  for (const [id, side] of plans) {
    const canvas = element(id);
    if (canvas.clientWidth > 0) {
      const fitted = planOf(side, shown.clip_mm, radius_mm, canvas.clientWidth, canvas.clientHeight);
      const plan = arePlansHeld ? drawnPlans.get(id) ?? fitted : fitted;
      drawnPlans.set(id, plan);
      drawPlan(canvas, side, {points, clip_mm: shown.clip_mm, radius_mm, plan});
    }
  }
}

/** Draws all in the next frame. */
function redraw() {
  if (!isDue) {
    isDue = true;
    requestAnimationFrame(() => {
      isDue = false;
      drawOverlay();
      drawPlans();
    });
  }
}

/** @param {Matrix} pose */
export function showPose(pose) {
  shown.pose = pose;
  redraw();
}

/** @param {number[]} clip_mm @param {boolean} isDragged  then the plans stay where they lie */
export function showClip(clip_mm, isDragged) {
  shown.clip_mm = clip_mm;
  arePlansHeld = isDragged;
  redraw();
}

/** The plans, with how each lies on its canvas once it is drawn. */
export const plansShown = () => plans.map(([id, side]) => (
  {canvas: /** @type {HTMLCanvasElement} */ (element(id)), side, planNow: () => drawnPlans.get(id) ?? null}));

/** @param {import('./api_calibration.js').Points} seen */
export function showPoints(seen) {
  shown.seen = seen;
  redraw();
}

function showDistance() {
  const {width} = element('pose-depth');
  show(element('pointed'), pointed !== null && picture !== null);
  if (pointed && picture) {
    const [x, y] = pointed;
    setText(element('pointed'), distanceText(distanceOf(picture[y * width + x])));
  }
}

/** @param {Blob} png */
export async function showPicture(png) {
  picture = await drawDepth(element('pose-depth'), png);
  show(element('pose-no-picture'), false);
  showDistance();
}

/** @param {string} why */
export function showNoPicture(why) {
  setText(part(element('pose-no-picture'), 'p'), why);
  show(element('pose-no-picture'), true);
}

/** @param {PointerEvent} event */
function point(event) {
  const {width, height} = element('pose-depth');
  const bounds = element('pose-depth').getBoundingClientRect();
  const at = [(event.clientX - bounds.left) / bounds.width, (event.clientY - bounds.top) / bounds.height];
  pointed = at.some((share) => share < 0 || share >= 1) ? null : [Math.floor(at[0] * width), Math.floor(at[1] * height)];
  const label = element('pointed');
  label.style.left = `${100 * at[0]}%`;
  label.style.top = `${100 * at[1]}%`;
  label.dataset.side = at[0] > 0.7 ? 'left' : 'right';
  showDistance();
}

export function preparePicture() {
  const frame = part(document, '.pose .frame');
  frame.addEventListener('pointermove', point);
  frame.addEventListener('pointerdown', point);
  frame.addEventListener('pointerleave', () => {
    pointed = null;
    showDistance();
  });
  for (const [id] of plans) {
    new ResizeObserver(redraw).observe(element(id));
  }
}
