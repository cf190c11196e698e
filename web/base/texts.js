// The page's texts in the reader's language. Each language is a file of texts/ with `texts`, the page's own texts by key, and `said`,
// translations of the scanner's sentences by their English originals. HTML gives keys in data-text, and in data-text-label, -title and
// -placeholder for the attributes of these names.

import {forget, note, noted} from './storage.js';

/** @typedef {Record<string, string | Partial<Record<Intl.LDMLPluralRule, string>>>} Texts */

const files = {
  en: () => import('../texts/en.js'),
  de: () => import('../texts/de.js'),
  es: () => import('../texts/es.js'),
  fr: () => import('../texts/fr.js'),
};

/** The languages' own names. */
export const languages = {en: 'English', de: 'Deutsch', es: 'Español', fr: 'Français'};

const memory = 'octurn-language';  // storage key of the chosen language

/**
 * The language to show. Pure.
 * @param {string | null} chosen @param {readonly string[]} preferred  language tags, most preferred first
 * @returns {keyof typeof files}
 */
export const languageOf = (chosen, preferred) => /** @type {keyof typeof files} */ (
  [chosen ?? '', ...preferred.map((tag) => tag.toLowerCase().split('-')[0])].find((language) => Object.hasOwn(files, language)) ?? 'en');

/** The locale of numbers and dates: "de-AT" for German, if the browser prefers that. Pure. @param {string} language @param {readonly string[]} preferred */
export const localeOf = (language, preferred) => preferred.find((tag) => tag.toLowerCase().split('-')[0] === language) ?? language;

/** The language chosen on this page; null: the browser's preference. @returns {string | null} */
export const chosenLanguage = () => noted(memory);

/** @param {string | null} language  null: the browser's preference */
export function chooseLanguage(language) {
  language === null ? forget(memory) : note(memory, language);
  location.reload();
}

const isInBrowser = typeof document !== 'undefined';
const preferred = isInBrowser ? navigator.languages : ['en-US'];

export const language = languageOf(isInBrowser ? chosenLanguage() : null, preferred);
export const locale = localeOf(language, preferred);

/** @type {{texts: Texts, said: Record<string, string>}} */
const {texts, said} = await files[language]();
const plurals = new Intl.PluralRules(locale);
const plain = new Intl.NumberFormat(locale, {maximumFractionDigits: 1});
const exact = new Intl.NumberFormat(locale, {maximumFractionDigits: 6, useGrouping: false});

/** @param {number} value */
export const number = (value) => plain.format(value);

/** @param {number} value @param {number} digits  after the point */
export const fixed = (value, digits) =>
  new Intl.NumberFormat(locale, {minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false}).format(value);

/** @param {string} key */
export const isText = (key) => Object.hasOwn(texts, key);

/**
 * @param {string} key
 * @param {Record<string, string | number>} [values]  `count` selects the plural form
 * @returns {string}
 */
export function text(key, values = {}) {
  const found = texts[key];
  const form = typeof found === 'string' ? found : found[plurals.select(Number(values.count))] ?? found.other ?? '';
  return form.replace(/\{(\w+)\}/g, (_, name) => typeof values[name] === 'number' ? exact.format(/** @type {number} */ (values[name])) : String(values[name]));
}

const value = /"[^"]*"|-?\d+(?:\.\d+)?/g;  // a value in the scanner's sentences: a name in quotes, or a number

/** The translation of a sentence as a whole, or null. @param {string} sentence @returns {string | null} */
function translatedWhole(sentence) {
  const key = sentence.replace(value, '{}');
  if (!Object.hasOwn(said, key)) {
    return null;
  }
  const shown = (sentence.match(value) ?? [])
      .map((one) => /^("|-?0\d)/.test(one) ? one : fixed(Number(one), one.split('.')[1]?.length ?? 0));
  let next = 0;
  return said[key].replace(/\{(\d?)\}/g, (_, place) => shown[place ? Number(place) - 1 : next++] ?? '');
}

/**
 * The translation of a sentence of which only the parts are known, such as "97 % of it has readings, 640 x 480"; or null.
 * @param {string} sentence @returns {string | null}
 */
function translatedParts(sentence) {
  const isWordless = !/[a-z]{2}/i.test(sentence);
  const whole = isWordless ? sentence : translatedWhole(sentence);
  if (whole !== null) {
    return whole;
  }
  for (const {0: separator, index = 0} of sentence.matchAll(/, |; /g)) {
    const head = sentence.slice(0, index);
    const first = /[a-z]{2}/i.test(head) ? translatedWhole(head) : head;
    const others = first === null ? null : translatedParts(sentence.slice(index + separator.length));
    if (others !== null) {
      return first + separator + others;
    }
  }
  return null;
}

const speaker = /^(?:sensor|no sensor was found): (?=\w+: )/;  // before the name of the driver that says the rest

/**
 * Translates a sentence of the scanner. It is looked up with {} in place of its values, which are put into the translation in
 * order, or by number ({2} is the second). An unknown sentence is returned unchanged.
 * @param {string} sentence
 */
export const translated = (sentence) => translatedParts(sentence.replace(speaker, '')) ?? sentence;

const unit = /(\d) (?=(?:[cm]?m[²³]?|m?s|min|h|[kMGT]?B|bytes?|°|V)(?![\p{L}\p{N}]))/gu;

const beforePercent = new Intl.NumberFormat(locale, {style: 'percent'}).format(1).slice(3, -1);  // "100 %" or "100%"

/**
 * Keeps a number and its unit on one line, and a dot between two parts on the line of the first. Sets 640 x 480 as
 * 640 × 480, and percentages as the language does. Pure.
 * @param {string} words
 */
export const typeset = (words) => words.replace(/(\d) (?=%)/g, `$1${beforePercent}`).replace(unit, '$1\u00a0')
    .replace(/(\S) · /g, '$1\u00a0· ').replace(/(\d) x (?=\d)/g, '$1 × ');

const attributes = {'data-text-label': 'aria-label', 'data-text-title': 'title', 'data-text-placeholder': 'placeholder'};

/**
 * Fills in the texts that HTML names by data-text attributes. Links to the guide lead to that in the language.
 * @param {ParentNode} root
 */
export function fillTexts(root) {
  for (const template of root.querySelectorAll('template')) {
    fillTexts(template.content);
  }
  for (const element of root.querySelectorAll('[data-text]')) {
    element.textContent = typeset(text(element.getAttribute('data-text') ?? ''));
  }
  for (const link of language === 'en' ? [] : root.querySelectorAll('a[href^="help/guide.html"]')) {
    link.setAttribute('href', (link.getAttribute('href') ?? '').replace('guide.', `guide.${language}.`));
  }
  for (const [name, attribute] of Object.entries(attributes)) {
    for (const element of root.querySelectorAll(`[${name}]`)) {
      element.setAttribute(attribute, text(element.getAttribute(name) ?? ''));
    }
  }
}
