// The choice of a leaf size by name.

import {copyOf, part, setText} from '../base/dom.js';
import {leaf} from '../base/format.js';
import {leafChoices} from './settings.js';
import {text} from '../base/texts.js';

/** Offers the named leaf sizes. @param {Element} parent @param {number} preset  initial choice, millimetres */
export function offerLeaves(parent, preset) {
  parent.replaceChildren(...leafChoices(preset).map(({mm, name}) => {
    const choice = copyOf('leaf');
    part(choice, 'input').value = mm;
    part(choice, 'input').checked = mm === preset;
    setText(part(choice, '.choice-name'), text(`leaf.${name}`));
    setText(part(choice, '.choice-mm'), leaf(mm));
    return choice;
  }));
}
