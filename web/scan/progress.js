// The view of a running scan. Pure.

import * as format from '../base/format.js';
import {text} from '../base/texts.js';
import {refusalText} from '../base/wording.js';

/** @typedef {import('../api/api.js').Scan} Scan */

const phasesAfterTheTurn = new Set(['calibrating', 'rebuilding', 'registering', 'building', 'done']);

/** @param {Scan} scan */
export function phaseText(scan) {
  const place = {stop: Math.min(scan.snapshots_done + 1, scan.snapshots_total), stops: scan.snapshots_total};
  if (scan.error) {
    return text('phase.again', place);
  }
  if (scan.snapshots_done === scan.snapshots_total && !phasesAfterTheTurn.has(scan.phase)) {
    return text('phase.last-look');
  }
  return text(`phase.${scan.phase === 'done' ? 'building' : scan.phase}`, place);
}

/** @param {Scan} scan */
export const isBuilding = ({phase}) => phasesAfterTheTurn.has(phase);

/**
 * Building takes a moment after the last stop, so the last three percent are reserved for it.
 * @param {Scan} scan
 */
function percent(scan) {
  return scan.snapshots_total > 0 ? Math.floor(97 * scan.snapshots_done / scan.snapshots_total) : 0;
}

const steps = /** @type {const} */ (['ready', 'capture', 'build']);

/** @param {Scan} scan */
function stepStates(scan) {
  const now = scan.phase === 'starting' ? 0 : isBuilding(scan) ? 2 : 1;
  return steps.map((name, index) => ({name, state: index < now ? 'done' : index === now ? 'now' : 'next'}));
}

/** Elapsed and total time. @param {Scan} scan */
const timeOf = ({seconds_elapsed, seconds_left, error}) => !seconds_left || error ? format.clock(seconds_elapsed) :
    text('time.of', {elapsed: format.clock(seconds_elapsed), total: format.clock(seconds_elapsed + seconds_left)});

/** How long a failed stop is still retried. @param {Scan} scan */
const untilPause = ({seconds_until_pause}) => seconds_until_pause === null ? '' :
    text('phase.pauses', {time: `${Math.ceil(seconds_until_pause)} s`});

/** @param {Scan} scan */
export const progressOf = (scan) => ({
  id: scan.id,
  phase: scan.phase,
  text: phaseText(scan),
  trouble: scan.error ? format.sentence(refusalText(scan.error)) : '',
  percent: percent(scan),
  done: scan.snapshots_done,
  total: scan.snapshots_total,
  left: scan.error ? untilPause(scan) : format.timeLeft(scan.seconds_left),
  time: timeOf(scan),
  steps: stepStates(scan),
});
