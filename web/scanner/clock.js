// The clock of an appliance without internet, which is set from the browser's clock.

import {json, sending} from '../api/api.js';

/** Whether an appliance's clock may be wrong. Pure. @param {import('../api/api.js').Status} status */
export const needsClock = ({appliance, warnings}) => appliance && Boolean(warnings?.some(({check}) => check === 'clock'));

const tolerance = 5 * 60e3;  // milliseconds; the scanner tells the minute, up to half a minute later

/** Whether a finding tells the same time as the browser: then the clock is right, whoever set it. Pure. @param {import('../api/api.js').Finding} finding @param {Date} now */
export function isRightClock({check, measured}, now) {
  const time = /^(\S+) (\d\d:\d\d) UTC/.exec(measured);
  return check === 'clock' && time !== null && Math.abs(Date.parse(`${time[1]}T${time[2]}Z`) - now.getTime()) < tolerance;
}

/** Sets the clock of an appliance that has no time server. */
export const sendClock = () => json('machine/clock', sending('PUT', {unix_s: Date.now() / 1000}));
