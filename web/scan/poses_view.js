// Renders the further poses of a scan's object: how they fit, and the buttons to add and remove them.

import {element, list, part, setText, show} from '../base/dom.js';
import {prepareFit} from './fit_view.js';
import {fetchFragment} from '../base/fragment.js';
import {text} from '../base/texts.js';

/** @typedef {ReturnType<import('./poses.js').posesOf>} Poses */

let isHere = false;  // whether the fragment is loaded
let isBegun = false;
/** @type {Poses | null} */
let last = null;

/** @param {Poses | null} poses  of the scan in view */
export function renderPoses(poses) {
  last = poses;
  show(element('sides'), Boolean(poses?.canAdd));
  if (!poses?.canAdd || !isHere) {
    return;
  }
  list(element('side-rows'), poses.rows, ({number}) => String(number), 'side-row', (item, row) => {
    item.dataset.tone = row.tone;
    setText(part(item, 'strong'), row.title);
    setText(part(item, 'p'), row.text);
    show(part(item, 'a'), row.open !== '');
    part(item, 'a').href = row.open;
    show(part(item, '[data-do=fit]'), row.canLook);
    part(item, '[data-do=fit]').setAttribute('aria-label', text('sides.fit-of', {side: row.number + 1}));
    show(part(item, '[data-do=remove]'), row.canRemove);
    part(item, '[data-do=remove]').setAttribute('aria-label', text('sides.remove-of', {side: row.number + 1}));
  });
  setText(element('side-add'), poses.add);
  element('side-add').setAttribute('aria-disabled', String(poses.isBusy));
}

/**
 * Fetches the fragment, once.
 * @param {{add: () => void, remove: (pose: number) => void, look: (pose: number) => void, choose: (choice: Object) => void}} actions
 */
export async function preparePoses(actions) {
  if (isBegun) {
    return;
  }
  isBegun = true;
  try {
    await fetchFragment(element('sides'), 'poses.html');
    isHere = true;
    element('side-add').addEventListener('click', () => last?.isBusy || actions.add());
    element('side-rows').addEventListener('click', (/** @type {any} */ event) => {
      const what = event.target.closest('[data-do]')?.dataset.do;
      const pose = Number(event.target.closest('li')?.dataset.key);
      if (what === 'remove') {
        actions.remove(pose);
      } else if (what === 'fit') {
        actions.look(pose);
      }
    });
    prepareFit(actions.choose);
    renderPoses(last);
  } catch {
    isBegun = false;  // retried at the next poll
  }
}
