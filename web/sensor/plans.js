// Draws the readings of one picture from the side and from above on canvases, with the platform, its axis and the scanned space.
// Lengths are millimetres in the platform's frame.

import {toPlatform} from '../base/pose.js';

/** @typedef {import('../base/pose.js').Matrix} Matrix */
/** @typedef {import('../base/pose.js').Point} Point */

/**
 * The axes of the platform's frame that point right and up in a plan.
 * @typedef {{right: 0 | 1, up: 1 | 2}} Side
 */
export const fromSide = /** @type {Side} */ ({right: 1, up: 2});
export const fromAbove = /** @type {Side} */ ({right: 0, up: 1});

const colours = {object: '#74d3cb', other: 'rgb(163 181 191 / 38%)', platform: '#e6eff3', axis: '#f4c95d', box: '#8fb8ff', text: '#a3b5bf'};
const margin = 34;  // pixels around platform and box

/** @typedef {{toPixel: (right: number, up: number) => [number, number], toMillimetres: (x: number, y: number) => [number, number], scale: number}} Plan */

/**
 * The mapping of a plan to a canvas, which shows the whole platform and box. Pure.
 * @param {Side} side @param {number[]} clip_mm @param {number} radius_mm @param {number} width @param {number} height
 * @returns {Plan}
 */
export function planOf({right, up}, clip_mm, radius_mm, width, height) {
  const left = Math.min(-radius_mm, clip_mm[right]);
  const far = Math.max(radius_mm, clip_mm[right + 3]);
  const low = up === 2 ? Math.min(-20, clip_mm[2]) : Math.min(-radius_mm, clip_mm[up]);
  const high = Math.max(up === 2 ? 60 : radius_mm, clip_mm[up + 3]);
  const scale = Math.max(0.05, Math.min((width - 2 * margin) / (far - left), (height - 2 * margin) / (high - low)));
  const middle = [(left + far) / 2, (low + high) / 2];
  return {
    scale,
    toPixel: (x, y) => [width / 2 + scale * (x - middle[0]), height / 2 - scale * (y - middle[1])],
    toMillimetres: (x, y) => [middle[0] + (x - width / 2) / scale, middle[1] - (y - height / 2) / scale],
  };
}

/** @param {number[]} clip_mm @param {Point} point  millimetres */
export const isInside = (clip_mm, point) => point.every((value, axis) => value >= clip_mm[axis] && value <= clip_mm[axis + 3]);

/** @param {Matrix} pose @param {Point[]} points_mm  in the optical frame @returns {Point[]} in the platform's, millimetres */
export const placed = (pose, points_mm) => points_mm.map((point) =>
  /** @type {Point} */ (toPlatform(pose, /** @type {Point} */ (point.map((value) => value / 1000))).map((value) => 1000 * value)));

/** @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Side} side @param {Point[]} points @param {number[]} clip_mm */
function drawPoints(context, {toPixel}, {right, up}, points, clip_mm) {
  for (const isObject of [false, true]) {
    context.fillStyle = isObject ? colours.object : colours.other;
    for (const point of points) {
      if (isInside(clip_mm, point) === isObject) {
        const [x, y] = toPixel(point[right], point[up]);
        context.fillRect(x - 1, y - 1, 2, 2);
      }
    }
  }
}

/** @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Side} side @param {number} radius_mm @param {number} top */
function drawPlatform(context, {toPixel, scale}, {up}, radius_mm, top) {
  const [x, y] = toPixel(0, 0);
  context.strokeStyle = colours.platform;
  context.beginPath();
  if (up === 2) {
    context.moveTo(...toPixel(-radius_mm, 0));
    context.lineTo(...toPixel(radius_mm, 0));
  } else {
    context.arc(x, y, radius_mm * scale, 0, 2 * Math.PI);
  }
  context.stroke();
  context.strokeStyle = colours.axis;
  context.beginPath();
  for (const [right, height] of up === 2 ? [[0, top]] : [[9 / scale, 0], [-9 / scale, 0], [0, 9 / scale], [0, -9 / scale]]) {
    context.moveTo(x, y);
    context.lineTo(...toPixel(right, height));
  }
  context.stroke();
}

/** @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Side} side @param {number[]} clip_mm */
function drawBox(context, {toPixel}, {right, up}, clip_mm) {
  const [x0, y0] = toPixel(clip_mm[right], clip_mm[up]);
  const [x1, y1] = toPixel(clip_mm[right + 3], clip_mm[up + 3]);
  context.strokeStyle = colours.box;
  context.setLineDash([5, 4]);
  context.strokeRect(x0, y1, x1 - x0, y0 - y1);
  context.setLineDash([]);
  context.fillStyle = colours.box;
  for (const [x, y] of [[x0, (y0 + y1) / 2], [x1, (y0 + y1) / 2], [(x0 + x1) / 2, y0], [(x0 + x1) / 2, y1]]) {
    context.fillRect(x - 3.5, y - 3.5, 7, 7);  // drag handle
  }
}

/** Sets a canvas's resolution to the screen's. @param {HTMLCanvasElement} canvas @returns {CanvasRenderingContext2D} in CSS pixels, empty */
export function contextOf(canvas) {
  const ratio = Math.min(devicePixelRatio, 2);
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (canvas.width !== width || canvas.height !== height) {
    [canvas.width, canvas.height] = [width, height];
  }
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return context;
}

/**
 * @param {HTMLCanvasElement} canvas @param {Side} side
 * @param {{points: Point[], clip_mm: number[], radius_mm: number, plan: Plan}} what  points: in the platform's frame, millimetres
 */
export function drawPlan(canvas, side, {points, clip_mm, radius_mm, plan}) {
  const context = contextOf(canvas);
  drawPoints(context, plan, side, points, clip_mm);
  context.lineWidth = 1.5;
  drawPlatform(context, plan, side, radius_mm, clip_mm[5]);
  drawBox(context, plan, side, clip_mm);
}

/**
 * Draws one of two pictures of a slice, both at the same scale.
 * @param {HTMLCanvasElement} canvas @param {number[][]} points @param {number[][]} all  of both pictures @param {string} colour
 */
export function drawSlice(canvas, points, all, colour) {
  const context = contextOf(canvas);
  const {clientWidth: width, clientHeight: height} = canvas;
  const [low, high] = [0, 1].reduce(([lows, highs], axis) => {
    const values = all.map((point) => point[axis]).sort((a, b) => a - b);
    const at = (/** @type {number} */ share) => values[Math.min(values.length - 1, Math.floor(share * values.length))];
    return [[...lows, at(0.005)], [...highs, at(0.995)]];
  }, /** @type {number[][]} */ ([[], []]));
  const scale = Math.min((width - 2 * margin) / Math.max(high[0] - low[0], 1), (height - 2 * margin) / Math.max(high[1] - low[1], 1));
  context.fillStyle = colour;
  for (const [x, y] of points) {
    context.fillRect(width / 2 + scale * (x - (low[0] + high[0]) / 2) - 1, height / 2 - scale * (y - (low[1] + high[1]) / 2) - 1, 2, 2);
  }
  drawLength(context, scale, height);
}

/** A scale bar. @param {CanvasRenderingContext2D} context @param {number} scale @param {number} height */
function drawLength(context, scale, height) {
  const length = [5, 10, 20, 50, 100].find((one) => one * scale > 40) ?? 100;
  context.fillStyle = colours.text;
  context.fillRect(14, height - 14, length * scale, 2);
  context.font = '12px system-ui, sans-serif';
  context.fillText(`${length} mm`, 14, height - 20);
}
