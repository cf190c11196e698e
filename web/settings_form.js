// The settings of the scanner as values, and as what is said of them. Pure.

/** @typedef {import('./api_settings.js').SettingSchema} SettingSchema */

/** Names for people, by key. */
const names = {
  'scan.snapshots': 'Snapshots a turn',
  'scan.method': 'Model',
  'scan.leaf_size_mm': 'Detail (leaf size)',
  'scan.filter': 'Depth filter',
  'scan.frames': 'Depth pictures a stop',
  'scan.max_error_mm': 'Simplification',
  'scan.parts': 'Parts',
  'scan.calibrate': 'Check of the pose',
  'scan.clip_mm': 'Scanned space',
  'scan.threshold_m2': 'Widest gap bridged, squared',
  'scan.root_size_mm': 'Root cube',
  'turntable.gear_ratio': 'Gear ratio',
  'turntable.full_steps': 'Full steps',
  'turntable.microsteps': 'Microsteps',
  'turntable.reversed': 'Turn the other way',
  'turntable.take_up_steps': 'Take-up of play',
  'turntable.speed_steps_per_s': 'Speed',
  'turntable.start_speed_steps_per_s': 'Start speed',
  'turntable.ramp_steps_per_s2': 'Acceleration',
  'turntable.settle_ms': 'Time to settle',
  'turntable.idle_release_s': 'Motor off after',
  'turntable.step_line': 'STEP',
  'turntable.direction_line': 'DIR',
  'turntable.enable_line': 'ENABLE',
  'turntable.microstep_lines': 'MS1, MS2, MS3',
  'memory_limit_mb': 'Memory',
  'threads': 'Threads',
  'host_names': 'Names of this scanner',
  'listen': 'Address',
  'port': 'Port',
};

/** Help where the schema's is for programs. @type {Record<string, string>} */
const help = {
  'scan.filter': 'Basic takes one depth picture, average the mean of several, and with discard only where each of them saw something.',
  'scan.parts': 'Of several things on the platform: the object alone, or all that stand there. Solid only.',
  'scan.threshold_m2': 'Square of the longest side that a triangle may have: 0.0001 bridges 10 mm. Intersection only.',
  'scan.root_size_mm': 'Side of the cube that is halved until its leaves are as small as asked for.',
  'scan.calibrate': 'A scan solves where the sensor stands by itself, and builds its model again if that is better.',
  'turntable.reversed': 'On if the platform turns clockwise, seen from above.',
  'turntable.take_up_steps': 'Against the play of gears: so far the platform goes back too far, and comes forward again. 0 for none.',
};

/** @type {Record<string, string>} */
const choices = {
  'basic': 'Basic', 'average': 'Average', 'average-discard': 'Average, discard',
  'auto': 'By each scan', 'told': 'None',
  'main': 'The object', 'all': 'All that stand',
  'solid': 'Solid', 'intersection': 'Intersection',
};

/** @param {string} key @returns {string} */
export const nameOf = (key) => /** @type {Record<string, string>} */ (names)[key] ?? key;

/** Help without Markdown, as a sentence. @param {string} key @param {SettingSchema} schema */
export function helpOf(key, schema) {
  const text = help[key] ?? schema.description.replaceAll('`', '');
  return text && `${text[0].toUpperCase()}${text.slice(1)}${text.endsWith('.') ? '' : '.'}`;
}

/** @param {string | number} choice */
export const choiceName = (choice) => choices[choice] ?? String(choice);

/** @param {any} tree @param {string} key  such as "turntable.gear_ratio" @returns {any} undefined where there is nothing */
export const valueAt = (tree, key) => key.split('.').reduce((value, part) => value?.[part], tree);

/** @param {any} schema  of an object @param {string} key @returns {SettingSchema} */
export const schemaAt = (schema, key) => key.split('.').reduce((now, part) => now.properties[part], schema);

/** A change of one setting, as the scanner takes it. @param {string} key @param {any} value */
export const changeOf = (key, value) => key.split('.').reduceRight((inner, part) => ({[part]: inner}), value);

/** @param {Object} one @param {Object} other @returns {any} the settings of both */
export function joined(one, other) {
  /** @type {any} */
  const both = {...one};
  for (const [key, value] of Object.entries(other)) {
    const isObject = value !== null && typeof value === 'object' && !Array.isArray(value);
    both[key] = isObject && both[key] ? joined(both[key], value) : value;
  }
  return both;
}

/** @param {any} one @param {any} other */
export const areEqual = (one, other) => JSON.stringify(one) === JSON.stringify(other);

/** Why a box is none, or nothing. @param {number[]} box */
function boxComplaint(box) {
  if (box.some((side) => !Number.isFinite(side) || Math.abs(side) > 10000)) {
    return 'Six numbers from -10000 to 10000.';
  }
  return [0, 1, 2].every((axis) => box[axis] < box[axis + 3]) ? '' : 'Each space must end beyond where it begins.';
}

/** Why a number is none that is allowed, or nothing. @param {SettingSchema} schema @param {any} value */
function numberComplaint({type, minimum, maximum}, value) {
  const range = `from ${minimum} to ${maximum}`;
  if (value === null || !Number.isFinite(value)) {
    return `A number ${range}.`;
  }
  if (type === 'integer' && !Number.isInteger(value)) {
    return `A whole number ${range}.`;
  }
  return value < Number(minimum) || value > Number(maximum) ? `It must be ${range}.` : '';
}

/**
 * Why a value is none that the scanner would take, or nothing.
 * @param {SettingSchema} schema @param {any} value
 */
export function complaintOf(schema, value) {
  if (schema.minItems) {
    return boxComplaint(value);
  }
  return schema.minimum === undefined ? '' : numberComplaint(schema, value);
}

/** The setting that a problem's detail is about: `"turntable.gear_ratio" is 0: ...`. @param {string} detail */
export const keyOf = (detail) => /^"([a-z0-9_.]+)"/.exec(detail)?.[1] ?? null;

/** What is wrong, without the setting's key. @param {string} detail */
export function reasonOf(detail) {
  const reason = /: (must be .*)$/s.exec(detail)?.[1];
  return reason ? `It ${reason}.` : detail;
}

/** A value as it stands in a sentence. @param {any} value */
export function valueText(value) {
  if (Array.isArray(value)) {
    return value.length > 0 ? value.join(', ') : 'none';
  }
  return typeof value === 'boolean' ? (value ? 'on' : 'off') : typeof value === 'string' ? choiceName(value) || 'none' : String(value);
}

/** A list as it is typed. @param {string} text @returns {string[]} */
export const wordsOf = (text) => text.split(/[\s,]+/).filter(Boolean);

const degrees = (/** @type {number} */ radians) => radians * 180 / Math.PI;

/**
 * Where a pose has the sensor, in words.
 * @param {number[][]} pose  platform_from_sensor, metres
 */
export function poseText(pose) {
  const [x, y, z] = pose.slice(0, 3).map((row) => row[3]);
  const down = -degrees(Math.atan2(pose[2][2], Math.hypot(pose[0][2], pose[1][2])));
  return `${Math.round(1000 * Math.hypot(x, y))} mm from the platform's axis, ${Math.round(1000 * z)} mm above its surface, ` +
      `looking ${Math.abs(down).toFixed(1)}° ${down < 0 ? 'up' : 'down'}.`;
}

/** Steps of a turn of the platform. @param {{full_steps: number, microsteps: number, gear_ratio: number}} turntable */
export const stepsOf = ({full_steps, microsteps, gear_ratio}) => Math.round(full_steps * microsteps * gear_ratio);

/** What to say while settings are not in force yet, or nothing. @param {string[]} keys @param {boolean} isScanning */
export function restartText(keys, isScanning) {
  if (keys.length === 0) {
    return '';
  }
  return isScanning ? 'Saved. The scanner takes it up when the scan has ended.' : 'Saved. The scanner starts again to take it up, in a few seconds.';
}
