// The fields of the settings page: one for each setting, built from its schema.

import {copyOf, part, setText, show} from '../base/dom.js';
import {asShown, choiceName, complaintOf, helpOf, nameOf, valueText, wordsOf} from './settings_form.js';
import {text, translated} from '../base/texts.js';

/** @typedef {import('../api/api_settings.js').SettingSchema} SettingSchema */

/**
 * @typedef {Object} Editor
 * @property {HTMLElement} root  the visible element
 * @property {HTMLElement} input  the labelled element
 * @property {() => any} read
 * @property {(value: any) => void} write
 */

/** @param {string} type @returns {HTMLInputElement} */
function inputOf(type) {
  const input = document.createElement('input');
  input.type = type;
  return input;
}

const rounded = (/** @type {number} */ value) => String(Number(value.toPrecision(6)));

/** @param {SettingSchema} schema @returns {Editor} */
function numberEditor(schema) {
  const input = inputOf('number');
  input.step = schema.type === 'integer' ? '1' : 'any';
  input.inputMode = schema.type === 'integer' ? 'numeric' : 'decimal';
  let exact = 0;  // value before rounding for display
  return {
    root: input, input,
    read: () => input.value === '' ? null : input.value === rounded(exact) ? exact : input.valueAsNumber,
    write: (value) => {
      exact = value;
      input.value = rounded(value);
    },
  };
}

/** @param {(string | number)[]} values @returns {Editor} */
function choiceEditor(values) {
  const input = document.createElement('select');
  input.append(...values.map((value) => new Option(choiceName(value), String(value))));
  return {
    root: input, input,
    read: () => values[input.selectedIndex],
    write: (value) => {
      input.selectedIndex = values.indexOf(value);
    },
  };
}

/** @returns {Editor} */
function flagEditor() {
  const input = inputOf('checkbox');
  input.className = 'switch';
  return {
    root: input, input,
    read: () => input.checked,
    write: (value) => {
      input.checked = value;
    },
  };
}

/** @param {boolean} isList @returns {Editor} */
function textEditor(isList) {
  const input = inputOf('text');
  input.autocapitalize = 'none';
  input.spellcheck = false;
  return {
    root: input, input,
    read: () => isList ? wordsOf(input.value) : input.value.trim(),
    write: (value) => {
      input.value = isList ? value.join(', ') : value;
    },
  };
}

/** @returns {Editor} */
function boxEditor() {
  const root = copyOf('box-fields');
  const sides = /** @type {HTMLInputElement[]} */ ([...root.querySelectorAll('input')])
      .sort((a, b) => Number(a.dataset.side) - Number(b.dataset.side));
  return {
    root, input: sides[0],
    read: () => sides.map((side) => side.valueAsNumber),
    write: (/** @type {number[]} */ value) => sides.forEach((side, index) => {
      side.value = String(value[index]);
    }),
  };
}

/** @param {SettingSchema} schema @returns {Editor} */
function editorOf(schema) {
  if (schema.enum) {
    return choiceEditor(schema.enum);
  }
  switch (schema.type) {
    case 'boolean': return flagEditor();
    case 'integer': case 'number': return numberEditor(schema);
    case 'array': return schema.minItems ? boxEditor() : textEditor(true);
    default: return textEditor(false);
  }
}

/**
 * @typedef {Object} SettingField
 * @property {string} key
 * @property {HTMLElement} root
 * @property {() => any} read
 * @property {(value: any, preset: any, isStored: boolean) => void} write
 * @property {(text: string) => void} complain  shows a complaint; an empty text removes it
 * @property {() => string} check  why its value is invalid, or empty
 * @property {() => void} focus
 */

/**
 * @param {string} key
 * @param {SettingSchema} stored
 * @param {() => void} onReset  called to restore the preset
 * @returns {SettingField}
 */
export function makeField(key, stored, onReset) {
  const {schema, toShown, toStored} = asShown(stored);
  const root = copyOf('setting');
  const editor = editorOf(schema);
  const [label, reset, help, complaint] = ['label', 'button', '.setting-help', '.setting-complaint'].map((one) => part(root, one));
  const id = `setting-${key.replaceAll('.', '-')}`;
  editor.input.id = id;
  label.htmlFor = id;
  complaint.id = `${id}-complaint`;
  help.id = `${id}-help`;
  editor.input.setAttribute('aria-describedby', `${help.id} ${complaint.id}`);
  setText(label, nameOf(key));
  const unit = translated(schema['x-unit'] ?? '');
  if (unit && unit.toLowerCase() !== nameOf(key).toLowerCase()) {  // the page's address is an address
    const span = document.createElement('span');
    span.className = 'muted';
    span.textContent = ` ${unit}`;
    label.append(span);
  }
  setText(help, schema.minItems ? '' : helpOf(key, schema));
  root.dataset.setting = key;
  root.classList.toggle('flag', schema.type === 'boolean');
  part(root, '.setting-input').append(editor.root);
  reset.addEventListener('click', onReset);
  /** @type {{value: any, shown: any}} */
  let written = {value: null, shown: null};
  const complain = (/** @type {string} */ text) => {
    setText(complaint, text);
    root.classList.toggle('wrong', text !== '');
    editor.input.setAttribute('aria-invalid', String(text !== ''));
  };
  return {
    key, root, complain,
    read: () => {
      const now = editor.read();
      return now === written.shown ? written.value : toStored(now);
    },
    write: (value, preset, isStored) => {
      written = {value, shown: toShown(value)};
      editor.write(written.shown);
      complain('');
      const was = schema.minItems ? text('settings.preset') : valueText(toShown(preset));
      setText(reset, text('settings.back-to', {value: was}));
      show(reset, isStored);
    },
    check: () => complaintOf(schema, editor.read()),
    focus: () => editor.input.focus(),
  };
}
