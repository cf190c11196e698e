// Quantities formatted for people.

import {fixed, locale, number, text, translated} from './texts.js';

export {number};

const date = new Intl.DateTimeFormat(locale, {dateStyle: 'medium', timeStyle: 'short'});
const byteUnits = ['byte', 'kilobyte', 'megabyte', 'gigabyte', 'terabyte'];

/** @param {number} value  bytes */
export function bytes(value) {
  let unit = 0;
  while (value >= 999.5 && unit < byteUnits.length - 1) {
    value /= 1000;
    ++unit;
  }
  const digits = unit > 0 && value < 9.95 ? 1 : 0;
  return new Intl.NumberFormat(locale,
      {style: 'unit', unit: byteUnits[unit], minimumFractionDigits: digits, maximumFractionDigits: digits}).format(value);
}

/** @param {number[]} sides  millimetres @param {number} [digits]  after the point */
export const size = (sides, digits = 1) => `${sides.map((side) => fixed(side, digits)).join(' × ')} mm`;

/** @param {number} value @param {number} [digits]  after the point; by default as many as a length needs: 0.52 mm, 18.4 mm */
export const millimetres = (value, digits = Math.abs(value) < 9.995 ? 2 : 1) => `${fixed(value, digits)} mm`;

/**
 * An error of a Kinect's disparity, as the distance that it makes at 75 cm, where objects stand.
 * @param {number} steps  of 1/345.489 per metre (core/include/octurn/sensor_map.hpp)
 */
export const disparity = (steps) => millimetres(steps * 0.75 ** 2 / 345.489 * 1000, 1);

/** A leaf's side. @param {number} value  millimetres */
export const leaf = (value) => `${number(value)} mm`;

/** @param {number} metres */
export const centimetres = (metres) => `${number(Math.round(100 * metres))} cm`;

/** @param {number} value @param {number} [digits]  after the point */
export const degrees = (value, digits = 2) => `${fixed(value, digits)}°`;

/** @param {number} share  of 1 @param {number} [digits]  after the point */
export const percent = (share, digits = 0) =>
  new Intl.NumberFormat(locale, {style: 'percent', minimumFractionDigits: digits, maximumFractionDigits: digits}).format(share);

/** @param {number} value  seconds */
export function duration(value) {
  if (value < 9.95) {
    return `${fixed(value, value < 0.995 ? 2 : 1)} s`;
  }
  const seconds = Math.round(value);
  const minutes = Math.floor(seconds / 60);
  if (minutes === 0) {
    return `${seconds} s`;
  }
  return minutes < 60 ? `${minutes} min ${seconds % 60} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/**
 * Remaining time, in coarse steps so that it does not flicker.
 * @param {number | null} seconds  null if unknown
 */
export function timeLeft(seconds) {
  if (seconds === null || seconds <= 0) {  // not known, or later than expected, and nobody knows by how much
    return '';
  }
  if (seconds < 3) {
    return text('time.moment');
  }
  if (seconds < 55) {
    return text('time.left', {time: `${Math.ceil(seconds / 5) * 5} s`});
  }
  return text('time.left', {time: `${Math.round(seconds / 60) || 1} min`});
}

/** As a clock: "0:07", "12:34", "1:02:03". @param {number} seconds */
export function clock(seconds) {
  const whole = Math.round(seconds);
  const two = (/** @type {number} */ value) => String(value).padStart(2, '0');
  const minutes = Math.floor(whole / 60);
  return minutes < 60 ? `${minutes}:${two(whole % 60)}` : `${Math.floor(minutes / 60)}:${two(minutes % 60)}:${two(whole % 60)}`;
}

/** An approximate duration. @param {number} seconds */
export function roughly(seconds) {
  const time = seconds < 100 ? `${Math.max(Math.round(seconds / 5) * 5, 5)} s` :
    seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${number(Math.round(seconds / 1800) / 2)} h`;
  return text('time.about', {time});
}

/** @param {string} iso */
export const when = (iso) => date.format(new Date(iso));

/** Capitalises the first letter. @param {string} words */
export const capital = (words) => words && words[0].toLocaleUpperCase(locale) + words.slice(1);

/** A message of the scanner as a sentence in the page's language. @param {string} said */
export function sentence(said) {
  const words = translated(said);
  return words && capital(words) + (/[.!?…]$/.test(words) ? '' : '.');
}
