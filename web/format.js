// Quantities as people read them.

const locale = 'en';
const plain = new Intl.NumberFormat(locale, {maximumFractionDigits: 1});
const date = new Intl.DateTimeFormat(locale,
    {day: 'numeric', month: 'short', year: 'numeric', hour: '2-digit', minute: '2-digit', hour12: false});

/** @param {number} value */
export const number = (value) => plain.format(value);

/** @param {number} value @param {string} unit  in the singular */
export const count = (value, unit) => `${number(value)} ${unit}${value === 1 ? '' : 's'}`;

/** @param {number} value  bytes */
export function bytes(value) {
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  let unit = 0;
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    ++unit;
  }
  return `${unit > 0 && value < 9.95 ? value.toFixed(1) : Math.round(value)} ${units[unit]}`;
}

/** @param {number[]} sides  millimetres @param {number} [digits]  after the point */
export const size = (sides, digits = 1) => `${sides.map((side) => side.toFixed(digits)).join(' × ')} mm`;

/** @param {number} value  seconds */
export function duration(value) {
  if (value < 9.95) {
    return `${value.toFixed(value < 0.995 ? 2 : 1)} s`;
  }
  const seconds = Math.round(value);
  const minutes = Math.floor(seconds / 60);
  if (minutes === 0) {
    return `${seconds} s`;
  }
  return minutes < 60 ? `${minutes} min ${seconds % 60} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/**
 * Time left, in steps so coarse that it does not flicker.
 * @param {number | null} seconds  null while nobody can tell
 */
export function timeLeft(seconds) {
  if (seconds === null) {
    return '';
  }
  if (seconds < 3) {
    return 'a moment left';
  }
  if (seconds < 55) {
    return `about ${Math.ceil(seconds / 5) * 5} s left`;
  }
  return `about ${Math.round(seconds / 60) || 1} min left`;
}

/** As a clock: "0:07", "12:34", "1:02:03". @param {number} seconds */
export function clock(seconds) {
  const whole = Math.round(seconds);
  const two = (/** @type {number} */ value) => String(value).padStart(2, '0');
  const minutes = Math.floor(whole / 60);
  return minutes < 60 ? `${minutes}:${two(whole % 60)}` : `${Math.floor(minutes / 60)}:${two(minutes % 60)}:${two(whole % 60)}`;
}

/** How long something takes, as people say it. @param {number} seconds */
export function roughly(seconds) {
  if (seconds < 100) {
    return `about ${Math.max(Math.round(seconds / 5) * 5, 5)} s`;
  }
  return seconds < 5400 ? `about ${Math.round(seconds / 60)} min` : `about ${plain.format(Math.round(seconds / 1800) / 2)} h`;
}

/** @param {string} iso */
export const when = (iso) => date.format(new Date(iso));

/** What a program says, as a sentence. @param {string} text */
export const sentence = (text) => text && text[0].toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? '' : '.');
