// The three presets of a scan. Pure.

import {leafChoices} from './settings.js';

/** @typedef {import('../api/api.js').Settings} Settings */

/**
 * @typedef {Object} Preset
 * @property {'quick' | 'standard' | 'best'} name
 * @property {Settings} settings
 */

const maxSnapshots = 400;

/**
 * Standard is the scanner's default. Quick and best have a third of and twice its snapshots, and the next coarser and finer leaves, so they
 * suit both a Kinect and a scan by laser line, which has more snapshots and smaller leaves.
 * @param {Settings} defaults
 * @returns {Preset[]}
 */
export function presets(defaults) {
  const sizes = leafChoices(defaults.leaf_size_mm).map(({mm}) => mm);
  const at = sizes.indexOf(defaults.leaf_size_mm);
  const quick = {snapshots: Math.ceil(defaults.snapshots / 3), leaf_size_mm: sizes[Math.max(at - 1, 0)]};
  const best = {snapshots: Math.min(2 * defaults.snapshots, maxSnapshots), leaf_size_mm: sizes[Math.min(at + 1, sizes.length - 1)]};
  return [
    {name: 'quick', settings: {...defaults, ...quick, filter: 'basic', method: 'solid'}},
    {name: 'standard', settings: defaults},
    {name: 'best', settings: {...defaults, ...best, method: 'solid'}},
  ];
}

/** A key of the settings, without those that the filter or the method does not use. @param {Partial<Settings>} settings */
const used = ({snapshots, filter, frames, method, leaf_size_mm, threshold_m2, calibrate, clip_mm}) => JSON.stringify([
  snapshots, filter, filter === 'basic' ? 0 : frames, method, leaf_size_mm, method === 'solid' ? 0 : threshold_m2, calibrate, clip_mm,
]);

/** @param {Partial<Settings>} settings @param {Settings} defaults @returns {Preset | null} the preset with these settings */
export const presetOf = (settings, defaults) => presets(defaults).find((preset) => used(preset.settings) === used(settings)) ?? null;

/** The settings stored in the browser; the sensor's pose and the scanned space belong to the scanner. */
const kept = /** @type {const} */ (['snapshots', 'filter', 'frames', 'method', 'leaf_size_mm', 'threshold_m2']);

/** @param {Partial<Settings>} settings @returns {string} */
export const toKept = (settings) => JSON.stringify(Object.fromEntries(kept.map((key) => [key, settings[key]])));

/**
 * The last choice, as far as it is still valid.
 * @param {string | null} text  from `toKept`, or anything else
 * @param {Settings} defaults
 * @returns {Settings}
 */
export function fromKept(text, defaults) {
  try {
    const found = JSON.parse(text ?? '{}') ?? {};
    const isOffered = leafChoices(defaults.leaf_size_mm).some(({mm}) => mm === found.leaf_size_mm);
    const usable = kept.filter((key) => typeof found[key] === typeof defaults[key] &&
      (typeof found[key] !== 'number' || found[key] > 0) && (key !== 'leaf_size_mm' || isOffered));
    return {...defaults, ...Object.fromEntries(usable.map((key) => [key, found[key]]))};
  } catch {
    return defaults;
  }
}
