// Warnings about the computer, shown without a check: power supply, temperature, disk, clock. The module that shows them is fetched with
// the first one.

import {isRightClock, needsClock, sendClock} from './clock.js';

/** @type {Promise<{showWarnings: (told: import('../api/api.js').Finding[]) => void}> | null} */
let lines = null;
let isClockSent = false;

/** @param {import('../api/api.js').Status} status */
export async function seeWarnings(status) {
  const warnings = (status.warnings ?? []).filter((finding) => !isRightClock(finding, new Date()));
  if (!isClockSent && needsClock(status)) {
    isClockSent = true;  // once per visit: if the clock cannot be set, only the warning stays
    sendClock().catch(() => {});
  }
  if (warnings.length > 0 || lines) {
    lines ??= import('./warning_lines.js');
    await lines.then(({showWarnings}) => showWarnings(warnings), () => {
      lines = null;  // retried at the next poll
    });
  }
}
