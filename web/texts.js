// The page's words in the language of its reader. Each language is a file of texts/: `texts`, the page's own words by key,
// and `said`, the scanner's sentences by the English ones. HTML names its keys as data-text, and as data-text-label,
// -title and -placeholder for the attributes of these names.

/** @typedef {Record<string, string | Partial<Record<Intl.LDMLPluralRule, string>>>} Texts */

const files = {
  en: () => import('./texts/en.js'),
  de: () => import('./texts/de.js'),
  es: () => import('./texts/es.js'),
  fr: () => import('./texts/fr.js'),
};

/** Their own names for themselves. */
export const languages = {en: 'English', de: 'Deutsch', es: 'Español', fr: 'Français'};

const memory = 'octurn-language';  // of the browser, where somebody has chosen one

/**
 * The language to show. Pure.
 * @param {string | null} chosen @param {readonly string[]} preferred  tags, the best first
 * @returns {keyof typeof files}
 */
export const languageOf = (chosen, preferred) => /** @type {keyof typeof files} */ (
  [chosen ?? '', ...preferred.map((tag) => tag.toLowerCase().split('-')[0])].find((language) => Object.hasOwn(files, language)) ?? 'en');

/** Where its numbers and dates are from: "de-AT" for German, if the browser prefers that. Pure. @param {string} language @param {readonly string[]} preferred */
export const localeOf = (language, preferred) => preferred.find((tag) => tag.toLowerCase().split('-')[0] === language) ?? language;

/** What was chosen on this page; null: whatever the browser prefers. @returns {string | null} */
export function chosenLanguage() {
  try {
    return localStorage.getItem(memory);
  } catch {
    return null;  // of a browser that keeps nothing
  }
}

/** @param {string | null} language  null: whatever the browser prefers */
export function chooseLanguage(language) {
  language === null ? localStorage.removeItem(memory) : localStorage.setItem(memory, language);
  location.reload();
}

const isInBrowser = typeof document !== 'undefined';
const preferred = isInBrowser ? navigator.languages : ['en-US'];

export const language = languageOf(isInBrowser ? chosenLanguage() : null, preferred);
export const locale = localeOf(language, preferred);

/** @type {{texts: Texts, said: Record<string, string>, rest?: () => Promise<{texts: Texts}>}} rest: what a packed language leaves for later */
const {texts, said, rest} = await files[language]();
const plurals = new Intl.PluralRules(locale);
const plain = new Intl.NumberFormat(locale, {maximumFractionDigits: 1});
const exact = new Intl.NumberFormat(locale, {maximumFractionDigits: 6, useGrouping: false});

/** Fetches the texts that the first sight of the page does without. */
export async function awaitTexts() {
  Object.assign(texts, (await rest?.())?.texts);
}

/** @param {number} value */
export const number = (value) => plain.format(value);

/** @param {number} value @param {number} digits  after the point */
export const fixed = (value, digits) =>
  new Intl.NumberFormat(locale, {minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false}).format(value);

/** @param {string} key */
export const isText = (key) => Object.hasOwn(texts, key);

/**
 * @param {string} key
 * @param {Record<string, string | number>} [values]  `count` chooses among the plurals
 * @returns {string}
 */
export function text(key, values = {}) {
  const found = texts[key];
  const form = typeof found === 'string' ? found : found[plurals.select(Number(values.count))] ?? found.other ?? '';
  return form.replace(/\{(\w+)\}/g, (_, name) => typeof values[name] === 'number' ? exact.format(/** @type {number} */ (values[name])) : String(values[name]));
}

const value = /"[^"]*"|-?\d+(?:\.\d+)?/g;  // that the scanner puts into its sentences: a name in quotes, or a number

/** The translation with {} for each value, or null. @param {string} sentence */
const saidOf = (sentence) => Object.hasOwn(said, sentence.replace(value, '{}')) ? said[sentence.replace(value, '{}')] : null;

/** A sentence that is known in its parts alone, such as "97 % of it has readings, 640 x 480". @param {string} sentence @returns {string} */
function translatedParts(sentence) {
  const parts = sentence.split(/(, |; )/);
  const isWordless = (/** @type {string} */ part) => !/[a-z]{2}/i.test(part);
  const isKnown = (/** @type {string} */ part) => isWordless(part) || saidOf(part) !== null;
  return parts.length > 1 && parts.every(isKnown) ? parts.map((part) => isWordless(part) ? part : translated(part)).join('') : sentence;
}

/**
 * What the scanner says, in the page's language: the sentence is looked up with its values taken out, which are put into
 * the translation in their order, or where {2} asks for the second. One that is not known is told as it is.
 * @param {string} sentence
 */
export function translated(sentence) {
  const values = sentence.match(value) ?? [];
  const known = saidOf(sentence);
  if (known === null) {
    return translatedParts(sentence);
  }
  const shown = values.map((one) => /^("|-?0\d)/.test(one) ? one : fixed(Number(one), one.split('.')[1]?.length ?? 0));
  let next = 0;
  return known.replace(/\{(\d?)\}/g, (_, place) => shown[place ? Number(place) - 1 : next++] ?? '');
}

const attributes = {'data-text-label': 'aria-label', 'data-text-title': 'title', 'data-text-placeholder': 'placeholder'};

/** Puts the words into what HTML names them in. @param {ParentNode} root */
export function fillTexts(root) {
  for (const template of root.querySelectorAll('template')) {
    fillTexts(template.content);
  }
  for (const element of root.querySelectorAll('[data-text]')) {
    element.textContent = text(element.getAttribute('data-text') ?? '');
  }
  for (const [name, attribute] of Object.entries(attributes)) {
    for (const element of root.querySelectorAll(`[${name}]`)) {
      element.setAttribute(attribute, text(element.getAttribute(name) ?? ''));
    }
  }
}
