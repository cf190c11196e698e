// "Keys for programs" in the settings: keys are created, shown once, and revoked.

import {Problem, json, sending, withoutAnswer} from '../api/api.js';
import {element, list, part, setText, setVerbatim, show} from '../base/dom.js';
import {sentence, when} from '../base/format.js';
import {text} from '../base/texts.js';

/** @typedef {{id: string, name: string, access: 'read' | 'full', created: string}} Key */

/** The description of a key. Pure. @param {Key} key */
export const aboutKey = ({access, created}) =>
  text(access === 'read' ? 'keys.may-read' : 'keys.may-all', {when: when(created)});

/** @type {Key[]} */
let keys = [];

/** @param {unknown} error */
function complain(error) {
  const {detail, title, hint} = error instanceof Problem ? error : new Problem('page', String(error));
  setText(element('key-complaint'), [detail || title, hint].map(sentence).join(' ').trim());
}

function render() {
  list(element('key-rows'), keys, ({id}) => id, 'key-row', (row, key) => {
    const name = key.name || key.id;
    setVerbatim(part(row, 'strong'), name);
    setText(part(row, 'p'), aboutKey(key));
    part(row, 'button').setAttribute('aria-label', text('keys.revoke-of', {name}));
  });
}

async function make() {
  setText(element('key-complaint'), '');
  const name = element('key-name').value.trim();
  if (name === '') {
    setText(element('key-complaint'), text('keys.unnamed'));
    element('key-name').focus();
    return;
  }
  try {
    const made = await json('keys', sending('POST', {name, access: element('key-access').value}));
    keys = [...keys, made];
    render();
    element('key-made').value = made.key;
    show(element('key-shown'), true);
    element('key-made').focus();
    element('key-made').select();
    element('key-name').value = '';
  } catch (error) {
    complain(error);
  }
}

/** @param {string} id */
async function revoke(id) {
  setText(element('key-complaint'), '');
  try {
    await withoutAnswer(`keys/${id}`, 'DELETE');
    keys = keys.filter((key) => key.id !== id);
    show(element('key-shown'), false);
    element('key-made').value = '';
    render();
  } catch (error) {
    complain(error);
  }
}

export async function prepareKeys() {
  element('keys-card').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    make();
  });
  element('key-rows').addEventListener('click', (/** @type {any} */ event) => {
    const row = event.target.closest('button') && event.target.closest('[data-key]');
    if (row) {
      revoke(row.dataset.key);
    }
  });
  try {
    ({keys} = await json('keys'));
    render();
  } catch (error) {
    complain(error);
  }
}
