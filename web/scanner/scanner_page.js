// The overview of the scanner: its check.

import {seeReport} from './checklist.js';
import {examine, prepareDoctor} from './doctor.js';

let isHere = false;  // whether the fragment is loaded
let isWanted = false;

/** Checks the scanner as soon as the fragment is loaded. */
export function check() {
  isHere ? examine(seeReport) : isWanted = true;
}

/** Attaches the handlers of doctor.html. */
export function prepare() {
  isHere = true;
  prepareDoctor(seeReport);
  isWanted && examine(seeReport);
}
