// "WiFi": which one the scanner is in, and which one it shall join.

import * as api from './api.js';
import {codes} from './countries.js';
import {element, list, part, setText, show} from './dom.js';
import {sentence} from './format.js';

/** @typedef {import('./api.js').Wifi} Wifi */
/** @typedef {import('./api.js').Network} Network */

const quoted = (/** @type {string} */ name) => `“${name}”`;

/** What to say of the WiFi. Pure. @param {Wifi} wifi */
export function summaryOf({state, name, hotspot}) {
  switch (state) {
    case 'joining': return `Joining ${quoted(name)}…`;
    case 'joined': return `The scanner is in ${quoted(name)}.`;
    case 'failed': return `The scanner is not in ${quoted(name)}.`;
    case 'hotspot': return `The scanner has a WiFi of its own, ${quoted(hotspot)}. Choose the one that it shall join.`;
    default: return 'The scanner is in no WiFi.';
  }
}

/** What is wrong, or nothing. Pure. @param {Wifi} wifi */
export const troubleOf = ({state, name, error}) => !error ? null :
  {title: state !== 'joined' && name ? `${quoted(name)} could not be joined` : 'The WiFi was not changed', detail: sentence(error)};

/** What comes if the scanner cannot join a WiFi. Pure. @param {Wifi} wifi */
const fallbackOf = ({hotspot}) => hotspot ? `If it cannot join, ${quoted(hotspot)} is back in about a minute, and this page says why there.` :
  'If it cannot join and has no cable, it makes a WiFi of its own in about a minute, where this page says why.';

/** What joining a WiFi means for who looks at this page. Pure. @param {Wifi} wifi @param {string} chosen @param {string} page  its address there */
export function consequenceOf(wifi, chosen, page) {
  const {state, name, hotspot} = wifi;
  const there = chosen ? quoted(chosen) : 'that WiFi';
  const leaves = state === 'hotspot' ? `The scanner leaves ${quoted(hotspot)} and joins ${there}.` :
    state === 'joined' && name !== chosen ? `The scanner leaves ${quoted(name)} and joins ${there}.` : `The scanner joins ${there}.`;
  return `${leaves} Then put this device into ${there}, too, and open ${page}. ${fallbackOf(wifi)}`;
}

/** How many of four bars a signal is worth. Pure. @param {number} dbm */
export const barsOf = (dbm) => dbm >= -55 ? 4 : dbm >= -65 ? 3 : dbm >= -75 ? 2 : 1;

/**
 * Networks in the order in which they are shown: those that are there keep their places, under a finger that wants one,
 * and the chosen one stays. Pure.
 * @param {Network[]} shown @param {Network[]} found @param {string | null} chosen
 */
export function inPlace(shown, found, chosen) {
  const now = new Map(found.map((network) => [network.name, network]));
  const staying = shown.filter(({name}) => now.has(name) || name === chosen).map((network) => now.get(network.name) ?? network);
  return [...staying, ...found.filter(({name}) => !shown.some((other) => other.name === name))];
}

/** Why a password is none, or nothing. Pure. @param {string} password @param {boolean} mayBeOpen */
export function passwordComplaint(password, mayBeOpen) {
  if (password === '') {
    return mayBeOpen ? '' : 'This WiFi has a password.';
  }
  if (password !== password.trim()) {
    return 'There is a blank before or after it.';
  }
  return /^([ -~]{8,63}|[0-9A-Fa-f]{64})$/.test(password) ? '' : 'A WiFi password has 8 to 63 letters, digits and signs, without accents.';
}

/** Why a name is none, or nothing. Pure. @param {string} name */
export const nameComplaint = (name) => name === '' ? 'Write the name of the WiFi.' :
  new TextEncoder().encode(name).length > 32 ? 'A WiFi has a shorter name.' : '';

/** Where somebody probably is: the region of the browser's language. Pure. @param {readonly string[]} languages */
export const regionOf = (languages) => languages.map((language) => /-([A-Z]{2})\b/.exec(language)?.[1] ?? '')
    .find((region) => codes.includes(region)) ?? '';

/** @type {Wifi} */
let wifi = {state: 'none', name: '', country: '', hotspot: '', error: '', host: '', networks: []};
/** @type {Network[]} */
let networks = [];
let isOpen = false;
let isAsked = false;  // from here, and not answered yet
let asked = '';  // the name of the WiFi that was asked for here last
let failure = '';
let said = '';  // the state that the form was opened or closed for

const page = () => `http://${wifi.host}.local${location.port ? `:${location.port}` : ''}`;

/** @returns {string | null} the network that is chosen, empty for one that is typed; null for none */
const chosen = () => part(element('wifi-form'), 'input[name=network]:checked')?.value ?? null;

const chosenName = () => chosen() || element('wifi-name').value.trim();

const isOpenWifi = () => networks.some(({name, secured}) => name === chosen() && !secured);

const farewell = () => `Put this device into ${quoted(asked)}, too, and open ${page()}. ${fallbackOf(wifi)}`;

function showNetworks() {
  list(element('networks'), networks, ({name}) => name, 'network', (item, {name, signal_dbm, secured}) => {
    part(item, 'input').value = name;
    setText(part(item, '.network-name'), name);
    part(item, '.network-signal use').setAttribute('href', `icons/symbols.svg#wifi-${barsOf(signal_dbm)}`);
    show(part(item, '.network-lock'), secured);
    setText(part(item, '.unseen'), `${secured ? ' with a password' : ' open'}, ${barsOf(signal_dbm)} of 4 bars`);
  });
}

function showFields() {
  const choice = chosen();
  const isTyped = choice === '';
  show(element('wifi-rest'), choice !== null);
  show(element('wifi-name-field'), isTyped);
  show(element('wifi-password-field'), choice !== null && !isOpenWifi());
  setText(element('wifi-password-text'), isTyped ? 'Leave it empty if the WiFi has none.' : '');
  const password = element('wifi-password');
  password.setCustomValidity(choice === null || isOpenWifi() ? '' : passwordComplaint(password.value, isTyped));
  element('wifi-name').setCustomValidity(isTyped ? nameComplaint(chosenName()) : '');
  setText(element('wifi-consequence'), consequenceOf(wifi, chosenName(), page()));
}

function render() {
  const isJoining = wifi.state === 'joining' || isAsked;
  const trouble = isJoining ? null : failure ? {title: 'The scanner was not told', detail: failure} : troubleOf(wifi);
  setText(element('wifi-summary'), isJoining ? summaryOf({...wifi, state: 'joining', name: asked || wifi.name}) : summaryOf(wifi));
  show(element('wifi-joining'), isJoining);
  setText(part(element('wifi-joining'), 'p'), asked ? farewell() : 'This takes up to a minute.');
  show(element('wifi-trouble'), trouble !== null);
  setText(part(element('wifi-trouble'), 'strong'), trouble?.title ?? '');
  setText(part(element('wifi-trouble'), 'p'), trouble?.detail ?? '');
  show(element('wifi-change'), !isJoining && !isOpen);
  setText(part(element('wifi-change'), 'span'), wifi.state === 'joined' ? 'Join another WiFi' : 'Join a WiFi');
  show(element('wifi-form'), !isJoining && isOpen);
  showNetworks();
  showFields();
}

/** @param {boolean} open */
function setOpen(open) {
  isOpen = open;
  networks = open ? wifi.networks : networks;
  render();
}

/** In the scanner's own WiFi this is what the page is for; elsewhere it is at the page's end. */
function place() {
  const isFirst = wifi.state === 'hotspot' || (wifi.hotspot !== '' && wifi.state === 'joining');
  const home = element(isFirst ? 'main' : 'appliance');
  if (element('wifi').parentElement !== home) {
    home.prepend(element('wifi'));
  }
}

/** @param {Wifi} news */
export function showWifi(news) {
  if (isAsked) {
    return;  // it is older than what was asked
  }
  wifi = news;
  networks = inPlace(networks, news.networks, chosen());
  if (element('wifi-country').value === '') {
    element('wifi-country').value = wifi.country || regionOf(navigator.languages);
  }
  if (wifi.state !== said && wifi.state !== 'joining') {
    said = wifi.state;
    isOpen = wifi.state === 'hotspot' || wifi.state === 'failed';
  }
  if (wifi.state === 'joined' && asked) {
    asked = '';
    element('wifi-password').value = '';
  }
  place();
  render();
}

/** What to say while the scanner does not answer, or null. */
export function wifiAway() {
  return asked && wifi.state === 'joining' ? {
    title: `The scanner joins ${quoted(asked)}.`,
    text: farewell(),
  } : null;
}

/** Whether news are expected soon. */
export const isJoining = () => wifi.state === 'joining';

async function join() {
  const password = element('wifi-password').value;
  const name = chosenName();
  const request = {name, country: element('wifi-country').value, ...(isOpenWifi() || password === '' ? {} : {password})};
  asked = name;
  failure = '';
  isAsked = true;
  render();
  try {
    wifi = await api.joinWifi(request);
    said = '';
  } catch (error) {
    const {title, detail, hint} = error instanceof api.Problem ? error : new api.Problem('page', String(error));
    asked = '';
    failure = [detail || title, hint].map(sentence).join(' ');
  }
  isAsked = false;
  place();
  render();
}

function offerCountries() {
  const names = new Intl.DisplayNames(['en'], {type: 'region'});
  const countries = codes.map((code) => ({code, name: names.of(code) ?? code})).sort((a, b) => a.name.localeCompare(b.name, 'en'));
  element('wifi-country').append(...countries.map(({code, name}) => new Option(name, code)));
}

export function prepareWifi() {
  offerCountries();
  const form = element('wifi-form');
  form.addEventListener('input', (/** @type {any} */ {target}) => {
    if (target.name === 'network') {
      element('wifi-password').value = '';  // it is another WiFi's
    }
    showFields();
  });
  form.addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    join();
  });
  element('wifi-change').addEventListener('click', () => {
    setOpen(true);
    part(form, 'input').focus({preventScroll: true});
  });
  element('wifi-show').addEventListener('click', () => {
    const isShown = element('wifi-password').type === 'text';
    element('wifi-password').type = isShown ? 'password' : 'text';
    element('wifi-show').setAttribute('aria-pressed', String(!isShown));
  });
}
