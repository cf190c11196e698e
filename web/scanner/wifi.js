// "WiFi": the scanner's current network, and the form to join another one.

import * as api from '../api/api.js';
import {codes} from './countries.js';
import {element, list, part, setText, setVerbatim, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {locale, text} from '../base/texts.js';
import {codePath, wifiCodeText} from './wifi_code.js';

/** @typedef {import('../api/api.js').Wifi} Wifi */
/** @typedef {import('../api/api.js').Network} Network */

/** The WiFi's state in words. Pure. @param {Wifi} wifi */
export function summaryOf({state, name, hotspot}) {
  switch (state) {
    case 'joining': return text('wifi.joining', {name});
    case 'joined': return text('wifi.joined', {name});
    case 'failed': return text('wifi.failed', {name});
    case 'hotspot': return text('wifi.hotspot', {name: hotspot});
    default: return text('wifi.none');
  }
}

/** The problem to show, or null. Pure. @param {Wifi} wifi */
export const troubleOf = ({state, name, error}) => !error ? null :
  {title: state !== 'joined' && name ? text('wifi.not-joined', {name}) : text('wifi.not-changed'), detail: sentence(error)};

/** What happens if the scanner cannot join a WiFi. Pure. @param {Wifi} wifi */
const fallbackOf = ({hotspot}) => hotspot ? text('wifi.back', {name: hotspot}) : text('wifi.fallback');

/** The consequence of joining a WiFi for this page's visitor. Pure. @param {Wifi} wifi @param {string} chosen @param {string} page  its address there */
export function consequenceOf(wifi, chosen, page) {
  const {state, name, hotspot} = wifi;
  const there = chosen ? text('wifi.there', {name: chosen}) : text('wifi.there-unnamed');
  const before = state === 'hotspot' ? hotspot : state === 'joined' && name !== chosen ? name : '';
  return [before ? text('wifi.leaves', {before, there}) : text('wifi.joins', {there}), text('wifi.follow', {there, page}), fallbackOf(wifi)].join(' ');
}

/**
 * The WiFi offered as a QR code: the scanner's own, or the one whose password was typed here. Pure.
 * @param {Wifi} wifi @param {{name: string, password: string} | null} wanted  the WiFi that the scanner was wanted to join
 */
export const sharedOf = ({state, hotspot}, wanted) => wanted ?? (state === 'hotspot' ? {name: hotspot, password: ''} : null);

/** The number of signal bars, 1 to 4. Pure. @param {number} dbm */
export const barsOf = (dbm) => dbm >= -55 ? 4 : dbm >= -65 ? 3 : dbm >= -75 ? 2 : 1;

/**
 * Networks in display order: shown ones keep their places, so that nothing moves under a finger, and the chosen one stays. Pure.
 * @param {Network[]} shown @param {Network[]} found @param {string | null} chosen
 */
export function inPlace(shown, found, chosen) {
  const now = new Map(found.map((network) => [network.name, network]));
  const staying = shown.filter(({name}) => now.has(name) || name === chosen).map((network) => now.get(network.name) ?? network);
  return [...staying, ...found.filter(({name}) => !shown.some((other) => other.name === name))];
}

/** Why a password is invalid, or an empty text. Pure. @param {string} password @param {boolean} mayBeOpen */
export function passwordComplaint(password, mayBeOpen) {
  if (password === '') {
    return mayBeOpen ? '' : text('wifi.needs-password');
  }
  if (password !== password.trim()) {
    return text('wifi.blank');
  }
  return /^([ -~]{8,63}|[0-9A-Fa-f]{64})$/.test(password) ? '' : text('wifi.password-shape');
}

/** Why a name is invalid, or an empty text. Pure. @param {string} name */
export const nameComplaint = (name) => name === '' ? text('wifi.needs-name') :
  new TextEncoder().encode(name).length > 32 ? text('wifi.name-long') : '';

/** The user's probable country: the region of the browser's language. Pure. @param {readonly string[]} languages */
export const regionOf = (languages) => languages.map((language) => /-([A-Z]{2})\b/.exec(language)?.[1] ?? '')
    .find((region) => codes.includes(region)) ?? '';

/** @type {Wifi} */
let wifi = {state: 'none', name: '', country: '', hotspot: '', error: '', host: '', networks: []};
/** @type {Network[]} */
let networks = [];
let isOpen = false;
let isAsked = false;  // whether a request is waiting for its response
let asked = '';  // name of the WiFi requested last on this page
let failure = '';
let said = '';  // the state for which the form was opened or closed

const page = () => `http://${wifi.host}.local${location.port ? `:${location.port}` : ''}`;

/** @returns {string | null} the chosen network; empty: a typed name; null: none */
const chosen = () => part(element('wifi-form'), 'input[name=network]:checked')?.value ?? null;

const chosenName = () => chosen() || element('wifi-name').value.trim();

const isOpenWifi = () => networks.some(({name, secured}) => name === chosen() && !secured);

const farewell = () => `${text('wifi.farewell', {there: text('wifi.there', {name: asked}), page: page()})} ${fallbackOf(wifi)}`;

function showNetworks() {
  list(element('networks'), networks, ({name}) => name, 'network', (item, {name, signal_dbm, secured}) => {
    part(item, 'input').value = name;
    setVerbatim(part(item, '.network-name'), name);
    part(item, '.network-signal use').setAttribute('href', `icons/symbols.svg#wifi-${barsOf(signal_dbm)}`);
    show(part(item, '.network-lock'), secured);
    setText(part(item, '.unseen'), text(secured ? 'wifi.secured' : 'wifi.open', {bars: barsOf(signal_dbm)}));
  });
}

function showFields() {
  const choice = chosen();
  const isTyped = choice === '';
  show(element('wifi-rest'), choice !== null);
  show(element('wifi-name-field'), isTyped);
  show(element('wifi-password-field'), choice !== null && !isOpenWifi());
  setText(element('wifi-password-text'), isTyped ? text('wifi.password-about') : '');
  const password = element('wifi-password');
  password.setCustomValidity(choice === null || isOpenWifi() ? '' : passwordComplaint(password.value, isTyped));
  element('wifi-name').setCustomValidity(isTyped ? nameComplaint(chosenName()) : '');
  setText(element('wifi-consequence'), consequenceOf(wifi, chosenName(), page()));
}

/** @param {{name: string, password: string} | null} shared */
function showCode(shared) {
  show(element('wifi-code'), shared !== null);
  if (shared) {
    const {size, path} = codePath(wifiCodeText(shared.name, shared.password));
    part(element('wifi-code'), 'svg').setAttribute('viewBox', `0 0 ${size} ${size}`);
    part(element('wifi-code'), 'path').setAttribute('d', path);
    setText(element('wifi-code-about'), text('wifi.code', {name: shared.name}));
  }
}

function render() {
  const isJoining = wifi.state === 'joining' || isAsked;
  const trouble = isJoining ? null : failure ? {title: text('wifi.not-sent'), detail: failure} : troubleOf(wifi);
  setText(element('wifi-summary'), isJoining ? summaryOf({...wifi, state: 'joining', name: asked || wifi.name}) : summaryOf(wifi));
  show(element('wifi-joining'), isJoining);
  setText(part(element('wifi-joining'), 'p'), asked ? farewell() : text('wifi.wait'));
  show(element('wifi-trouble'), trouble !== null);
  setText(part(element('wifi-trouble'), 'strong'), trouble?.title ?? '');
  setText(part(element('wifi-trouble'), 'p'), trouble?.detail ?? '');
  showCode(sharedOf(wifi, isJoining && asked ? {name: asked, password: isOpenWifi() ? '' : element('wifi-password').value} : null));
  show(element('wifi-change'), !isJoining && !isOpen);
  setText(part(element('wifi-change'), 'span'), text(wifi.state === 'joined' ? 'wifi.join-another' : 'wifi.join-one'));
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

/** Moves the card: in the scanner's own WiFi to the top of the page, otherwise to the end. */
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
    return;  // older than the pending request
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

/** The explanation why the scanner does not answer, or null. */
export function wifiAway() {
  return asked && wifi.state === 'joining' ? {
    title: text('wifi.joins-title', {name: asked}),
    text: farewell(),
  } : null;
}

/** Whether changes are expected soon. */
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
  const names = new Intl.DisplayNames([locale], {type: 'region'});
  const countries = codes.map((code) => ({code, name: names.of(code) ?? code})).sort((a, b) => a.name.localeCompare(b.name, locale));
  element('wifi-country').append(...countries.map(({code, name}) => new Option(name, code)));
}

export function prepareWifi() {
  offerCountries();
  const form = element('wifi-form');
  form.addEventListener('input', (/** @type {any} */ {target}) => {
    if (target.name === 'network') {
      element('wifi-password').value = '';  // it was for another WiFi
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
