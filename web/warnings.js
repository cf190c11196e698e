// Warnings about the computer, shown without a check: power supply, temperature, disk, clock.

import {element, list, part, setText, show} from './dom.js';
import {sentence} from './format.js';
import {needsClock, sendClock} from './power.js';
import {translated} from './texts.js';

/** @typedef {import('./api.js').Finding} Finding */

const tones = /** @type {Record<string, string>} */ ({fault: 'bad', warning: 'warn'});

/** The text of a warning. Pure. @param {Finding} finding */
export const textOf = ({name, measured, advice}) => ({title: `${translated(name)}: ${translated(measured)}.`, text: sentence(advice)});

let isClockSent = false;

/** @param {import('./api.js').Status} status */
export function seeWarnings(status) {
  const warnings = status.warnings ?? [];
  show(element('warnings'), warnings.length > 0);
  list(element('warnings'), warnings, ({check}) => check, 'machine-warning', (item, finding) => {
    const {title, text} = textOf(finding);
    item.dataset.tone = tones[finding.state] ?? '';
    setText(part(item, 'strong'), title);
    setText(part(item, 'span'), text);
  });
  if (!isClockSent && needsClock(status)) {
    isClockSent = true;  // once per visit: if the clock cannot be set, only the warning stays
    sendClock().catch(() => {});
  }
}
