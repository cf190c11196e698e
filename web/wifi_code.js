// A WiFi as a QR code: who points a phone's camera at it is asked whether to join.

import {encode} from './uqr.js';

const quiet = 4;  // modules around it that a reader needs empty: ISO/IEC 18004, 9.1

/** What means something to a reader has a backslash before it. @param {string} value */
const escaped = (value) => value.replace(/[\\;,:"]/g, '\\$&');

/** The text of the code, in the format of ZXing that phones have adopted. Pure. @param {string} name @param {string} password  empty: it has none */
export const wifiCodeText = (name, password) =>
  `WIFI:T:${password ? 'WPA' : 'nopass'};S:${escaped(name)};${password ? `P:${escaped(password)};` : ''};`;

/** The dark modules of a code as a path of SVG, in a drawing of `size` x `size`. Pure. @param {string} words */
export function codePath(words) {
  const {size, data} = encode(words, {ecc: 'M', border: quiet});
  return {size, path: data.flatMap((row, y) => row.map((isDark, x) => isDark ? `M${x} ${y}h1v1h-1z` : '')).join('')};
}
