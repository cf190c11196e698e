// Conversion of a scan's settings between the form and the API.

import {number, text} from '../base/texts.js';

/** @typedef {import('../api/api.js').Settings} Settings */

/** @typedef {{mm: number, name: string}} Detail  name: of the texts leaf.NAME */

/** Named leaf sizes, coarse to fine. Each is half the previous one, like the octree's levels. */
const details = [
  {mm: 4, name: 'draft'},
  {mm: 2, name: 'coarse'},
  {mm: 1, name: 'medium'},
  {mm: 0.5, name: 'fine'},
  {mm: 0.25, name: 'finest'},
];

/**
 * The leaf sizes to choose from: the named ones from four times to half the preset or to 0.5 mm, and the preset itself.
 * @param {number} preset  millimetres
 * @returns {Detail[]} coarse to fine
 */
export function leafChoices(preset) {
  const near = details.filter(({mm}) => mm <= 4 * preset && mm > Math.min(preset, 1) / 4);
  return near.some(({mm}) => mm === preset) ? near : [...near, {mm: preset, name: 'preset'}].sort((a, b) => b.mm - a.mm);
}

/** @param {Settings['filter'] | Settings['method'] | Settings['calibrate']} choice */
export const explain = (choice) => text(`explain.${choice}`);

/** The longest edge, millimetres, for a threshold of squared length. */
export const gap = (/** @type {number} */ squareMetres) => Number((Math.sqrt(squareMetres) * 1000).toPrecision(6));
/** The threshold, m², for a longest edge. */
export const threshold = (/** @type {number} */ mm) => Number(((mm / 1000) ** 2).toPrecision(6));

/**
 * @typedef {Object} Form
 * @property {number} snapshots
 * @property {number} leaf_size_mm
 * @property {Settings['filter']} filter
 * @property {number} frames
 * @property {Settings['method']} method
 * @property {number} gap_mm  the longest edge between neighbouring readings
 * @property {Settings['calibrate']} calibrate
 * @property {number[]} clip_mm
 */

/** @param {Settings} settings @returns {Form} */
export const formOf = ({snapshots, method, leaf_size_mm, filter, frames, threshold_m2, calibrate, clip_mm}) =>
    ({snapshots, method, leaf_size_mm, filter, frames, gap_mm: gap(threshold_m2), calibrate, clip_mm});

/** @param {Form} form @returns {Partial<Settings>} */
export const settingsOf = ({snapshots, method, leaf_size_mm, filter, frames, gap_mm, calibrate, clip_mm}) =>
    ({snapshots, method, leaf_size_mm, filter, frames, threshold_m2: threshold(gap_mm), calibrate, clip_mm});

/**
 * Angle between two stops.
 * @param {number} snapshots
 */
export const stepText = (snapshots) => text('form.step', {angle: `${number(360 / snapshots)}°`});
