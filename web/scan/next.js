// "Next object": a scan with the settings of the one in view, for many objects in a row. Pure.

import {text} from '../base/texts.js';

/** @typedef {import('../api/api.js').Scan} Scan */

const maxName = 100;  // characters

/**
 * A name with its last number raised until no scan has it, or with a number added. Leading zeros stay.
 * @param {string} name @param {Set<string>} taken @returns {string}
 */
export function nextName(name, taken) {
  const [, before, gap, digits, after] = /^(.*?)()(\d+)(\D*)$/s.exec(name) ?? ['', name, ' ', '1', ''];
  for (let number = BigInt(digits) + 1n; ; ++number) {
    const ending = gap + String(number).padStart(digits.length, '0') + after;
    const next = [...before].slice(0, Math.max(maxName - [...ending].length, 0)).join('') + ending;
    if (!taken.has(next)) {
      return next;
    }
  }
}

/**
 * What starts the scan of the next object. The sensor's pose and scale are those in force then, not those of this scan.
 * @param {Scan} scan @param {Scan[]} scans  all
 */
export function nextScan({name, settings, tags, author, licence}, scans) {
  const {platform_from_sensor, depth_scale, ...same} = settings;
  return {...same, name: nextName(name || text('next.unnamed'), new Set(scans.map((scan) => scan.name))), tags, author, licence};
}
