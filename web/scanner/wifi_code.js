// A WiFi as a QR code, which a phone's camera offers to join.

import {encode} from '../uqr.js';

const quiet = 4;  // quiet zone in modules: ISO/IEC 18004, 9.1

/** Escapes special characters with a backslash. @param {string} value */
const escaped = (value) => value.replace(/[\\;,:"]/g, '\\$&');

/** The code's text in ZXing's WiFi format, which phones support. Pure. @param {string} name @param {string} password  empty: open network */
export const wifiCodeText = (name, password) =>
  `WIFI:T:${password ? 'WPA' : 'nopass'};S:${escaped(name)};${password ? `P:${escaped(password)};` : ''};`;

/** The dark modules of a QR code as an SVG path in a view box of `size` x `size`. Pure. @param {string} words */
export function codePath(words) {
  const {size, data} = encode(words, {ecc: 'M', border: quiet});
  return {size, path: data.flatMap((row, y) => row.map((isDark, x) => isDark ? `M${x} ${y}h1v1h-1z` : '')).join('')};
}
