// The overview of the scanner: its check.

import {seeReport} from './checklist.js';
import {examine, prepareDoctor} from './doctor.js';

let isHere = false;  // its part of the page
let isWanted = false;

/** Checks the scanner, once its part of the page is there. */
export function check() {
  isHere ? examine(seeReport) : isWanted = true;
}

/** Makes the part of the page work that doctor.html is. */
export function prepare() {
  isHere = true;
  prepareDoctor(seeReport);
  isWanted && examine(seeReport);
}
