// DOM functions shared by the page's modules.

import {typeset} from './texts.js';

/** @param {string} id @returns {any} the element with that id */
export const element = (id) => document.getElementById(id);

/** Shows what somebody wrote, such as a name, as it is. It is set only if it differs, so that selections stay and screen
 * readers announce only changes. @param {Element} target @param {string} words */
export function setVerbatim(target, words) {
  if (target.textContent !== words) {
    target.textContent = words;
  }
}

/** The same for a text of the page or of the scanner, which is typeset. @param {Element} target @param {string} text */
export const setText = (target, text) => setVerbatim(target, typeset(text));

/** @param {HTMLElement} target @param {{tone?: string, text: string}} badge */
export function setBadge(target, {tone, text}) {
  setText(target, text);
  target.dataset.tone = tone ?? '';
}

/** @param {Element} target  may be an SVG element, which has no `hidden` property @param {boolean} isShown */
export function show(target, isShown) {
  target.toggleAttribute('hidden', !isShown);
}

/** @param {string} id  of a toggle button @param {boolean} isPressed */
export function pressed(id, isPressed) {
  element(id).setAttribute('aria-pressed', String(isPressed));
}

/** @param {string} id  of a template with one element @returns {any} a copy of it */
export const copyOf = (id) => element(id).content.firstElementChild.cloneNode(true);

/** @param {ParentNode} parent @param {string} selector @returns {any} */
export const part = (parent, selector) => parent.querySelector(selector);

/**
 * Renders `items` as the children of `parent`, in order. An item that stays keeps its element and so its focus.
 *
 * @template Item
 * @param {Element} parent
 * @param {Item[]} items
 * @param {(item: Item) => string} keyOf
 * @param {string} template
 * @param {(child: any, item: Item) => void} fill
 */
export function list(parent, items, keyOf, template, fill) {
  const known = new Map([...parent.children].map((child) => [/** @type {HTMLElement} */ (child).dataset.key, child]));
  items.forEach((item, index) => {
    const key = keyOf(item);
    const child = known.get(key) ?? copyOf(template);
    known.delete(key);
    child.dataset.key = key;
    fill(child, item);
    if (parent.children[index] !== child) {
      parent.insertBefore(child, parent.children[index] ?? null);
    }
  });
  for (const child of known.values()) {
    child.remove();
  }
}
