// The three ways to scan that stand in front of all settings. Pure.

/** @typedef {import('./api.js').Settings} Settings */

/**
 * @typedef {Object} Preset
 * @property {'quick' | 'standard' | 'best'} name
 * @property {Settings} settings
 */

/**
 * Standard is what the scanner scans with unless told otherwise; the others have the same space and pose.
 * @param {Settings} defaults
 * @returns {Preset[]}
 */
export const presets = (defaults) => [
  {name: 'quick', settings: {...defaults, snapshots: 12, filter: 'basic', method: 'solid', leaf_size_mm: 2}},
  {name: 'standard', settings: defaults},
  {name: 'best', settings: {...defaults, snapshots: 72, filter: 'average', frames: 10, method: 'solid', leaf_size_mm: 0.5}},
];

/** Settings that a filter or a method does not use do not count. @param {Partial<Settings>} settings */
const used = ({snapshots, filter, frames, method, leaf_size_mm, threshold_m2, calibrate, clip_mm}) => JSON.stringify([
  snapshots, filter, filter === 'basic' ? 0 : frames, method, leaf_size_mm, method === 'solid' ? 0 : threshold_m2, calibrate, clip_mm,
]);

/** @param {Partial<Settings>} settings @param {Settings} defaults @returns {Preset | null} the one that these are */
export const presetOf = (settings, defaults) => presets(defaults).find((preset) => used(preset.settings) === used(settings)) ?? null;

/** What a browser remembers of a scan: not where the sensor stands, nor the space, which belong to the scanner. */
const kept = /** @type {const} */ (['snapshots', 'filter', 'frames', 'method', 'leaf_size_mm', 'threshold_m2']);

/** @param {Partial<Settings>} settings @returns {string} */
export const toKept = (settings) => JSON.stringify(Object.fromEntries(kept.map((key) => [key, settings[key]])));

/**
 * What was chosen last, as far as it is still something to choose.
 * @param {string | null} text  as `toKept` has made it, or somebody else
 * @param {Settings} defaults
 * @returns {Settings}
 */
export function fromKept(text, defaults) {
  try {
    const found = JSON.parse(text ?? '{}') ?? {};
    const usable = kept.filter((key) => typeof found[key] === typeof defaults[key] && (typeof found[key] !== 'number' || found[key] > 0));
    return {...defaults, ...Object.fromEntries(usable.map((key) => [key, found[key]]))};
  } catch {
    return defaults;
  }
}
