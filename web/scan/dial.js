// The dial of a running scan: the turn from above, with a tick for each stop.

const centre = 110;
const inner = 88;
const outer = 102;

/** @param {number} radius @param {number} share  of a turn, clockwise from the top */
function point(radius, share) {
  const angle = 2 * Math.PI * share;
  return `${(centre + radius * Math.sin(angle)).toFixed(2)} ${(centre - radius * Math.cos(angle)).toFixed(2)}`;
}

/**
 * @param {number} from
 * @param {number} to
 * @param {number} total
 * @returns {string} the SVG path of ticks `from` up to, but not including, `to`, of `total` around the dial
 */
export function ticks(from, to, total) {
  let path = '';
  for (let i = from; i < to; ++i) {
    path += `M${point(inner, i / total)}L${point(outer, i / total)}`;
  }
  return path;
}

/** @param {number} total @returns {number} width of a tick that leaves gaps between neighbours */
export const tickWidth = (total) => Math.min(7, 0.55 * 2 * Math.PI * inner / total);
