// The live depth picture with the rig drawn in by a pose, the distance under the pointer, and plans of the readings from the
// side and from above.

import {handlesOf} from './clip_handles.js';
import {drawDepth} from './depth.js';
import {element, part, setText, show} from '../base/dom.js';
import {drawPlan, fromAbove, fromSide, placed, planOf} from './plans.js';
import {drawLines, prepareDistance, radius_mm} from './rig_picture.js';

/** @typedef {import('../base/pose.js').Matrix} Matrix */

const plans = /** @type {const} */ ([['plan-side', fromSide], ['plan-above', fromAbove]]);

/** @type {Map<string, import('./plans.js').Plan>} as drawn last */
const drawnPlans = new Map();
let arePlansHeld = false;  // during a drag in them

/** @type {{pose: Matrix | null, clip_mm: number[], seen: import('../api/api_calibration.js').Points | null}} */
const shown = {pose: null, clip_mm: [-140, -140, 5, 140, 140, 400], seen: null};

/** @type {ReturnType<typeof prepareDistance>} */
let seeDistances = () => {};
let isDue = false;

/** The rig in the live picture: pose, sensor and scanned space; null before the first picture. */
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
  const rig = rigShown();
  if (rig) {
    drawLines(element('overlay'), rig);
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

/** Redraws in the next animation frame. */
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

/** @param {number[]} clip_mm @param {boolean} isDragged  whether the plans keep their mapping */
export function showClip(clip_mm, isDragged) {
  shown.clip_mm = clip_mm;
  arePlansHeld = isDragged;
  redraw();
}

/** The plans, each with its mapping once it is drawn. */
export const plansShown = () => plans.map(([id, side]) => (
  {canvas: /** @type {HTMLCanvasElement} */ (element(id)), side, planNow: () => drawnPlans.get(id) ?? null}));

/** @param {import('../api/api_calibration.js').Points} seen */
export function showPoints(seen) {
  shown.seen = seen;
  redraw();
}

/** @param {Blob} png @param {import('./overlay.js').Sensor} sensor */
export async function showPicture(png, sensor) {
  seeDistances(await drawDepth(element('pose-depth'), png), sensor);
  show(element('pose-no-picture'), false);
}

/** @param {string} why */
export function showNoPicture(why) {
  setText(part(element('pose-no-picture'), 'p'), why);
  show(element('pose-no-picture'), true);
}

export function preparePicture() {
  seeDistances = prepareDistance(part(document, '.pose .frame'), element('pointed'));
  for (const [id] of plans) {
    new ResizeObserver(redraw).observe(element(id));
  }
}
