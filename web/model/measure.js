// Measuring a model between points that are picked, as words and as drawings. Pure; points are millimetres in the view.

import {degrees, millimetres, size} from '../base/format.js';
import {fixed, text} from '../base/texts.js';
import {dot} from './section.js';

/** @typedef {'distance' | 'diameter' | 'angle' | 'size'} Kind */

/**
 * Drawn on top of the model.
 * @typedef {Object} Drawing
 * @property {number[][]} [points]
 * @property {number[][][]} [lines]  each through its points
 * @property {{at: number[], words: string}[]} [labels]
 */

/** How many points each kind needs. @type {Record<Kind, number>} */
const needed = {distance: 2, diameter: 3, angle: 3, size: 0};

const sides = 96;  // of a drawn circle
const off = 0.07;  // of the largest side: from the model to a dimension line

const minus = (/** @type {number[]} */ a, /** @type {number[]} */ b) => a.map((value, axis) => value - b[axis]);
const between = (/** @type {number[]} */ a, /** @type {number[]} */ b) => a.map((value, axis) => (value + b[axis]) / 2);

/**
 * Adds a point, the first of a new measurement if all are there.
 * @param {Kind} kind @param {number[][]} points @param {number[]} point
 */
export const withPoint = (kind, points, point) => points.length < needed[kind] ? [...points, point] : [point];

/** The angle at the middle one of three points, degrees. @param {number[][]} points */
export function angleOf([a, corner, b]) {
  const [one, other] = [minus(a, corner), minus(b, corner)];
  const cosine = dot(one, other) / Math.sqrt(dot(one, one) * dot(other, other));
  return Math.acos(Math.min(Math.max(cosine, -1), 1)) * 180 / Math.PI;
}

/**
 * The circle through three points.
 * @param {number[][]} points
 * @returns {{center: number[], radius: number, axes: number[][]} | null}  null: they lie on a line
 */
export function circleOf([a, b, c]) {
  const [p, q] = [minus(b, a), minus(c, a)];
  const [pp, pq, qq] = [dot(p, p), dot(p, q), dot(q, q)];
  const spread = pp * qq - pq * pq;  // the square of twice the triangle's area
  if (spread < 1e-6 * pp * qq || spread === 0) {
    return null;
  }
  const [s, t] = [qq * (pp - pq) / (2 * spread), pp * (qq - pq) / (2 * spread)];
  const radius = Math.hypot(...p.map((value, axis) => s * value + t * q[axis]));
  const along = p.map((value) => value / Math.sqrt(pp));
  const across = q.map((value, axis) => value - dot(q, along) * along[axis]);
  return {
    center: a.map((value, axis) => value + s * p[axis] + t * q[axis]),
    radius,
    axes: [along, across.map((value) => value / Math.sqrt(dot(across, across)))],
  };
}

/** @param {Kind} kind @param {number[][]} points  all that it needs */
function measured(kind, points) {
  if (kind === 'angle') {
    return degrees(angleOf(points), 1);
  }
  const circle = kind === 'diameter' ? circleOf(points) : null;
  return kind === 'distance' ? millimetres(Math.hypot(...minus(points[0], points[1])), 1) :
    circle ? `⌀ ${millimetres(2 * circle.radius, 1)}` : '';
}

/** @param {Kind} kind  with points to pick @param {number[][]} points */
export function measureText(kind, points) {
  if (points.length < needed[kind]) {
    const first = kind === 'diameter' ? 'view.diameter-first' : 'view.measure-first';
    return kind === 'angle' ? text(`view.angle-${points.length}`) :
      text(points.length > 0 ? 'view.measure-next' : first);
  }
  const words = measured(kind, points);
  if (kind !== 'distance') {
    return words || text('view.diameter-line');
  }
  const [x, y, z] = minus(points[0], points[1]).map((value) => fixed(Math.abs(value), 1));
  return text('view.measured', {distance: words, x, y, z});
}

/** @param {Kind} kind @param {number[][]} points @returns {Drawing} */
export function measureDrawing(kind, points) {
  if (points.length < needed[kind]) {
    return {points, lines: kind === 'angle' ? [points] : []};
  }
  const words = measured(kind, points);
  if (kind !== 'diameter') {
    const at = kind === 'angle' ? points[1] : between(points[0], points[1]);
    return {points, lines: [points], labels: [{at, words}]};
  }
  const circle = circleOf(points);
  if (!circle) {
    return {points};
  }
  const {center, radius, axes: [u, v]} = circle;
  const rim = Array.from({length: sides + 1}, (_, i) => {
    const [cosine, sine] = [Math.cos(2 * Math.PI * i / sides), Math.sin(2 * Math.PI * i / sides)];
    return center.map((value, axis) => value + radius * (cosine * u[axis] + sine * v[axis]));
  });
  return {points, lines: [rim, [rim[0], rim[sides / 2]]], labels: [{at: center, words}]};
}

/** @typedef {{min: number[], max: number[]}} Box */

/** @param {Box} box */
const sidesOf = ({min, max}) => minus(max, min);

/** @param {Box} box */
export const sizeText = (box) => text('view.size', {size: size(sidesOf(box))});

/**
 * Dimension lines: of the width in front of a box, of depth and height on its right.
 * @param {Box} box @returns {Drawing}
 */
export function sizeDrawing(box) {
  const {min, max} = box;
  const lengths = sidesOf(box);
  const gap = off * Math.max(...lengths);
  const [right, front] = [max[0] + gap, min[1] - gap];
  const ends = [
    {from: [min[0], front, min[2]], to: [max[0], front, min[2]], tick: [0, gap, 0]},
    {from: [right, min[1], min[2]], to: [right, max[1], min[2]], tick: [gap, 0, 0]},
    {from: [right, max[1], min[2]], to: [right, max[1], max[2]], tick: [gap, 0, 0]},
  ];
  const beside = (/** @type {number[]} */ at, /** @type {number[]} */ tick, /** @type {number} */ share) =>
    at.map((value, axis) => value + share * tick[axis]);
  return {
    lines: ends.flatMap(({from, to, tick}) =>
      [[from, to], ...[from, to].map((at) => [beside(at, tick, -0.3), beside(at, tick, 0.3)])]),
    labels: ends.map(({from, to}, axis) => ({at: between(from, to), words: millimetres(lengths[axis], 1)})),
  };
}

/** @param {ReturnType<typeof import('./section.js').sectionOf>} section */
export function sectionText(section) {
  if (section === null) {
    return text('view.section-none');
  }
  const {width, height, area} = section;
  const sides = size([width, height]);
  return area === null ? text('view.section-open', {size: sides}) : text('view.section', {size: sides, area: fixed(area, 1)});
}
