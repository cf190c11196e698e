// "Settings": the scanner's persistent settings, on cards that are saved separately.

import {Problem, status} from '../api/api.js';
import {calibration} from '../api/api_calibration.js';
import * as api from '../api/api_settings.js';
import {sourceOf} from './calibration.js';
import {copyOf, element, part, setText, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {here} from '../places.js';
import {makeField} from './settings_fields.js';
import {areEqual, changeOf, joined, keyOf, poseText, reasonOf, restartText, schemaAt, stepsOf, valueAt} from './settings_form.js';
import {prepareKeys} from './keys.js';
import {prepareMachine} from './machine.js';
import {prepareOutgoing} from './outgoing.js';
import {preparePower} from './power.js';
import {chooseLanguage, chosenLanguage, languages, text} from '../base/texts.js';
import {chooseTheme, chosenTheme} from '../base/theme.js';
import {prepareTurntable} from './turntable.js';

/** @typedef {import('../api/api_settings.js').Configuration} Configuration */
/** @typedef {import('./settings_fields.js').SettingField} SettingField */

const pauseUntilRestarted = 500;  // milliseconds between polls

/** @typedef {{form: HTMLFormElement, fields: SettingField[], saved: HTMLElement, actions: HTMLElement}} Card */

/** @type {Configuration} */
let configuration;
/** @type {Card[]} */
const cards = [];

/** The stored value of a setting, whether in force yet or not. @param {string} key */
const valueOf = (key) => valueAt(configuration.stored, key) ?? valueAt(configuration.preset, key);

/** @param {SettingField} field */
const isChanged = (field) => !areEqual(field.read(), valueOf(field.key));

/** @param {unknown} error @returns {Problem} */
const problemOf = (error) => error instanceof Problem ? error : new Problem('page', String(error));

/** @param {Problem} problem */
const wordsOf = ({detail, title, hint}) => [detail || title, hint].map(sentence).join(' ').trim();

/** @param {Card} card */
function writeCard({fields}) {
  for (const field of fields) {
    field.write(valueOf(field.key), valueAt(configuration.preset, field.key), valueAt(configuration.stored, field.key) !== undefined);
  }
}

/** @param {Card} card */
function showChanged({fields, actions}) {
  const changed = fields.some(isChanged);
  for (const button of actions.querySelectorAll('button')) {
    show(button, changed);
  }
}

function showPassword() {
  const {password} = configuration;
  setText(element('password-about'), text(`settings.password-${password === 'octurn.json' ? 'file' : password}`));
  show(element('password-remove'), password === 'page');
}

/** Shows the pose in force, which a scan may change without changing a setting. */
async function showPose() {
  try {
    const pose = await calibration();
    setText(element('pose-text'), poseText(pose.platform_from_sensor));
    setText(element('pose-source'), sentence(sourceOf(pose)));
  } catch (error) {
    setText(element('pose-text'), wordsOf(problemOf(error)));
    setText(element('pose-source'), '');
  }
}

function showNews() {
  const {stored, preset, trouble, settings} = configuration;
  show(element('camera-card'), settings.sensor === 'laser-line');
  show(element('settings-trouble'), trouble !== '');
  setText(part(element('settings-trouble'), 'p'), sentence(trouble));
  setText(element('turntable-about'),
      text('settings.turntable-about', {steps: stepsOf({...preset.turntable, ...stored.turntable})}));
  showPassword();
  showPose();
}

async function showRestart() {
  const isScanning = configuration.restart_needed.length > 0 && (await status()).scan !== null;
  const text = restartText(configuration.restart_needed, isScanning);
  setText(part(element('settings-restart'), 'p'), text);
  show(element('settings-restart'), text !== '');
}

let isFollowing = false;

/** Polls until the saved settings are in force. */
async function followRestart() {
  if (isFollowing) {
    return;
  }
  isFollowing = true;
  while (configuration.restart_needed.length > 0) {
    await showRestart().catch(() => {});  // it does not answer while it restarts
    await new Promise((done) => {
      setTimeout(done, pauseUntilRestarted);
    });
    configuration = await api.configuration().catch(() => configuration);
  }
  isFollowing = false;
  show(element('settings-restart'), false);
  showNews();
  for (const card of cards.filter(({fields}) => !fields.some(isChanged))) {
    writeCard(card);
  }
}

/** @param {Configuration} news */
function take(news) {
  configuration = news;
  showNews();
  followRestart();
}

/** @param {Card} card @param {Problem} problem */
function showProblem({fields, saved}, problem) {
  const key = keyOf(problem);
  const field = fields.find((one) => one.key === key);
  if (field) {
    field.complain(reasonOf(problem));
    field.focus();
  } else {
    setText(saved, wordsOf(problem));
  }
  saved.dataset.tone = field ? '' : 'bad';
}

/** @param {Card} card @param {Object} change @returns {Promise<boolean>} whether it is stored */
async function save(card, change) {
  setText(card.saved, '');
  try {
    take(await api.changeSettings(change));
    writeCard(card);
    showChanged(card);
    card.saved.dataset.tone = 'good';
    setText(card.saved, text('saved'));
    return true;
  } catch (error) {
    showProblem(card, problemOf(error));
    return false;
  }
}

/** @param {Card} card */
function saveChanged(card) {
  const complaints = card.fields.map((field) => ({field, text: field.check()}));
  complaints.forEach(({field, text}) => field.complain(text));
  const wrong = complaints.find(({text}) => text !== '');
  if (wrong) {
    wrong.field.root.closest('details')?.setAttribute('open', '');
    wrong.field.focus();
    return;
  }
  const changes = card.fields.filter(isChanged).map((field) => changeOf(field.key, field.read()));
  if (changes.length > 0) {
    save(card, changes.reduce(joined, {}));
  }
}

/** @param {HTMLFormElement} form @returns {Card} */
function makeCard(form) {
  form.append(copyOf('card-actions'));
  /** @type {Card} */
  const card = {form, fields: [], saved: part(form, '.saved'), actions: part(form, '.actions')};
  for (const place of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll('[data-fields]'))) {
    for (const key of (place.dataset.fields ?? '').split(' ')) {
      const field = makeField(key, schemaAt(configuration.settings_schema, key), () => save(card, changeOf(key, null)));
      place.append(field.root);
      card.fields.push(field);
    }
  }
  form.addEventListener('input', () => {
    setText(card.saved, '');
    showChanged(card);
  });
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    saveChanged(card);
  });
  part(card.actions, '[data-do=discard]').addEventListener('click', () => {
    writeCard(card);
    showChanged(card);
  });
  writeCard(card);
  showChanged(card);
  return card;
}

/** Stores the settings that a test of the turntable advises. @param {Object} set @returns {Promise<boolean>} whether it is stored */
async function setTurntable(set) {
  while (isFollowing) {
    await new Promise((done) => {
      setTimeout(done, pauseUntilRestarted);
    });
  }
  const card = cards.find(({fields}) => fields.some(({key}) => key.startsWith('turntable.')));
  return card !== undefined && save(card, {turntable: set});
}

/** @param {string | null} password */
async function setPassword(password) {
  setText(element('password-complaint'), '');
  try {
    take(await api.setPassword(password));
    element('page-password').value = '';
  } catch (error) {
    setText(element('password-complaint'), wordsOf(problemOf(error)));
  }
}

function preparePassword() {
  const input = element('page-password');
  element('password-card').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    const bytes = new TextEncoder().encode(input.value).length;
    const isRight = [...input.value].length >= 8 && bytes <= 100;
    isRight ? setPassword(input.value) : setText(element('password-complaint'), text('settings.password-length'));
  });
  element('password-remove').addEventListener('click', () => setPassword(null));
  element('password-show').addEventListener('click', () => {
    const isShown = input.type === 'text';
    input.type = isShown ? 'password' : 'text';
    element('password-show').setAttribute('aria-pressed', String(!isShown));
  });
}

async function restore() {
  const file = element('restore-file').files[0];
  setText(element('restore-complaint'), '');
  setText(element('restore-done'), '');
  try {
    take(await api.restoreSettings(await file.text()));
    cards.forEach(writeCard);
    cards.forEach(showChanged);
    element('restore-done').dataset.tone = 'good';
    setText(element('restore-done'), text('settings.restored'));
  } catch (error) {
    setText(element('restore-complaint'), wordsOf(problemOf(error)));
  }
  element('restore-file').value = '';  // otherwise choosing the same file again would have no effect
}

async function begin() {
  try {
    configuration = await api.configuration();
  } catch (error) {
    setText(part(element('settings-away'), 'strong'), text('settings.late'));
    setText(part(element('settings-away'), 'p'), wordsOf(problemOf(error)));
    show(element('settings-away'), true);
    setTimeout(begin, 4 * pauseUntilRestarted);
    return;
  }
  show(element('settings-away'), false);
  for (const form of /** @type {NodeListOf<HTMLFormElement>} */ (document.querySelectorAll('form[data-card]'))) {
    cards.push(makeCard(form));
  }
  show(element('cards'), true);
  prepareKeys();
  prepareOutgoing();
  preparePower();
  prepareTurntable(setTurntable);
  take(configuration);
}

function prepareLanguage() {
  const choice = element('language');
  choice.append(...Object.entries(languages).map(([code, name]) => new Option(name, code)));
  choice.value = chosenLanguage() ?? '';
  choice.addEventListener('change', () => chooseLanguage(choice.value || null));
}

function prepareTheme() {
  const choice = element('theme');
  choice.value = chosenTheme() ?? '';
  choice.addEventListener('change', () => chooseTheme(choice.value || null));
}

/** Attaches the handlers of settings.html. */
export function prepare() {
  prepareLanguage();
  prepareTheme();
  preparePassword();
  prepareMachine();
  element('restore-file').addEventListener('change', restore);
  addEventListener('hashchange', () => here() === 'settings' && showPose());
  begin();
}
