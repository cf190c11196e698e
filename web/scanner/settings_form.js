// Values of the scanner's settings, and texts about them. Pure.

import {degrees as angle, millimetres, sentence} from '../base/format.js';
import {gap, threshold} from '../scan/settings.js';
import {isText, text} from '../base/texts.js';

/** @typedef {import('../api/api_settings.js').SettingSchema} SettingSchema */
/** @typedef {{detail: string, parameters?: Record<string, any>}} Refusal */

/** @param {string} key @returns {string} for people */
export const nameOf = (key) => isText(`setting.${key}`) ? text(`setting.${key}`) : key;

/** The help text of a setting: the page's own, or the scanner's without Markdown. @param {string} key @param {SettingSchema} schema */
export const helpOf = (key, schema) => isText(`setting-help.${key}`) ? text(`setting-help.${key}`) : sentence(schema.description.replaceAll('`', ''));

/** @param {string | number} choice */
export const choiceName = (choice) => isText(`choice.${choice}`) ? text(`choice.${choice}`) : String(choice);

/** @param {any} tree @param {string} key  such as "turntable.gear_ratio" @returns {any} undefined if there is none */
export const valueAt = (tree, key) => key.split('.').reduce((value, part) => value?.[part], tree);

/** @param {any} schema  of an object @param {string} key @returns {SettingSchema} */
export const schemaAt = (schema, key) => key.split('.').reduce((now, part) => now.properties[part], schema);

/** The API's change document for one setting. @param {string} key @param {any} value */
export const changeOf = (key, value) => key.split('.').reduceRight((inner, part) => ({[part]: inner}), value);

/** Merges two documents of settings. @param {Object} one @param {Object} other @returns {any} */
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

/** Why a box is invalid, or an empty text. @param {number[]} box */
function boxComplaint(box) {
  if (box.some((side) => !Number.isFinite(side) || Math.abs(side) > 10000)) {
    return text('settings.box-range');
  }
  return [0, 1, 2].every((axis) => box[axis] < box[axis + 3]) ? '' : text('settings.box-empty');
}

/** Why a number is invalid, or an empty text. @param {SettingSchema} schema @param {any} value */
function numberComplaint({type, minimum, maximum}, value) {
  const range = {minimum: minimum ?? 0, maximum: maximum ?? 0};
  if (value === null || !Number.isFinite(value)) {
    return text('settings.number', range);
  }
  if (type === 'integer' && !Number.isInteger(value)) {
    return text('settings.whole', range);
  }
  return value < Number(minimum) || value > Number(maximum) ? text('settings.range', range) : '';
}

/**
 * Why the scanner would refuse a value, or an empty text.
 * @param {SettingSchema} schema @param {any} value
 */
export function complaintOf(schema, value) {
  if (schema.minItems) {
    return boxComplaint(value);
  }
  return schema.minimum === undefined ? '' : numberComplaint(schema, value);
}

/**
 * How a setting is shown: a square of a length, as the scanner keeps it, as that length in millimetres.
 * @param {SettingSchema} schema
 * @returns {{schema: SettingSchema, toShown: (value: any) => any, toStored: (shown: any) => any}}
 */
export function asShown(schema) {
  const same = (/** @type {any} */ value) => value;
  if (schema['x-unit'] !== 'm2') {
    return {schema, toShown: same, toStored: same};
  }
  const [minimum, maximum] = [schema.minimum, schema.maximum].map((value) => gap(Number(value)));
  return {schema: {...schema, 'x-unit': 'mm', minimum, maximum}, toShown: gap, toStored: threshold};
}

/** The setting to which a problem refers, for example in `"ports": unknown key`. @param {Refusal} problem */
export const keyOf = ({detail, parameters = {}}) => parameters.key ?? /^"([a-z0-9_.]+)"/.exec(detail)?.[1] ?? null;

/** The reason of a problem, without the setting's key. @param {Refusal} problem */
export function reasonOf({detail, parameters = {}}) {
  const {minimum, maximum} = parameters;
  if (minimum !== undefined) {
    return text('settings.range', {minimum, maximum});
  }
  const reason = /: (must be .*)$/s.exec(detail)?.[1];
  return reason ? sentence(`it ${reason}`) : detail;
}

/** A value for use in a sentence. @param {any} value */
export function valueText(value) {
  if (Array.isArray(value)) {
    return value.length > 0 ? value.join(', ') : text('settings.none');
  }
  return typeof value === 'boolean' ? text(value ? 'settings.on' : 'settings.off') : typeof value === 'string' ? choiceName(value) || text('settings.none') : String(value);
}

/** Splits a typed list into words. @param {string} text @returns {string[]} */
export const wordsOf = (text) => text.split(/[\s,]+/).filter(Boolean);

const degrees = (/** @type {number} */ radians) => radians * 180 / Math.PI;

/**
 * The sensor's position and direction in words.
 * @param {number[][]} pose  platform_from_sensor, metres
 */
export function poseText(pose) {
  const [x, y, z] = pose.slice(0, 3).map((row) => row[3]);
  const down = -degrees(Math.atan2(pose[2][2], Math.hypot(pose[0][2], pose[1][2])));
  return text(down < 0 ? 'pose.up' : 'pose.down', {
    distance: millimetres(1000 * Math.hypot(x, y), 0), height: millimetres(1000 * z, 0), angle: angle(Math.abs(down), 1)});
}

/** The microsteps of a full turn of the platform. @param {{full_steps: number, microsteps: number, gear_ratio: number}} turntable */
export const stepsOf = ({full_steps, microsteps, gear_ratio}) => Math.round(full_steps * microsteps * gear_ratio);

/** The notice for settings that need a restart, or an empty text. @param {string[]} keys @param {boolean} isScanning */
export function restartText(keys, isScanning) {
  if (keys.length === 0) {
    return '';
  }
  return text(isScanning ? 'settings.restart-later' : 'settings.restart');
}
