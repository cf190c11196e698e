// "Printers" and "Notify other programs" in the settings: the receivers of models, and of webhooks.

import {Problem, json, sending, withoutAnswer} from '../api/api.js';
import {element, list, part, setText, setVerbatim, show} from '../base/dom.js';
import {fetchFragment} from '../base/fragment.js';
import {sentence} from '../base/format.js';
import {text} from '../base/texts.js';

/**
 * @typedef {{id: string, name: string, kind: string, address: string, has_key: boolean, fingerprint: string}} Printer
 */
/** @typedef {{outcome: 'waiting' | 'delivered' | 'failed', event: string, time: string | null, trouble: string}} Told */
/** @typedef {{id: string, address: string, events: string[], last: Told | null}} Webhook */

const kinds = /** @type {Record<string, string>} */ ({octoprint: 'OctoPrint', moonraker: 'Moonraker', prusalink: 'PrusaLink'});
const pause = 1000;  // milliseconds between polls of a delivery
const looks = 15;

/** The description of a printer. Pure. @param {Printer} printer */
export const aboutPrinter = ({kind, address, fingerprint}) =>
  `${kinds[kind]} · ${address}${fingerprint && ` · ${text('outgoing.fingerprint', {fingerprint})}`}`;

/** The outcome of the last message. Pure. @param {Webhook} webhook */
export function aboutWebhook({last}) {
  const words = {
    delivered: () => text('outgoing.arrived'),
    waiting: () => last?.trouble ? text('outgoing.again', {trouble: last.trouble}) : text('outgoing.going'),
    failed: () => text('outgoing.lost', {trouble: last?.trouble ?? ''}),
  };
  return last ? words[last.outcome]() : text('outgoing.none');
}

/** @param {string} place @param {unknown} error */
function complain(place, error) {
  const {detail, title, hint} = error instanceof Problem ? error : new Problem('page', String(error));
  setText(element(place), [detail || title, hint].map(sentence).join(' ').trim());
}

/** @param {string} place @param {() => Promise<void>} action */
async function attempt(place, action) {
  setText(element(place), '');
  try {
    await action();
  } catch (error) {
    complain(place, error);
  }
}

async function showPrinters() {
  const {printers} = await json('printers');
  list(element('printer-rows'), printers, ({id}) => id, 'outgoing-row', (row, printer) => {
    setVerbatim(part(row, 'strong'), printer.name);
    setText(part(row, 'p'), aboutPrinter(printer));
    show(part(row, '[data-do=test]'), false);
    part(row, '[data-do=remove]').setAttribute('aria-label', text('outgoing.remove-of', {name: printer.name}));
  });
}

/** @returns {Promise<Webhook[]>} */
async function showWebhooks() {
  const {webhooks} = await json('webhooks');
  list(element('webhook-rows'), webhooks, ({id}) => id, 'outgoing-row', (row, webhook) => {
    setVerbatim(part(row, 'strong'), webhook.address);
    setText(part(row, 'p'), aboutWebhook(webhook));
    part(row, '[data-do=test]').setAttribute('aria-label', text('outgoing.test-of', {name: webhook.address}));
    part(row, '[data-do=remove]').setAttribute('aria-label', text('outgoing.remove-of', {name: webhook.address}));
  });
  return webhooks;
}

/** @param {string} id */
async function testWebhook(id) {
  await json(`webhooks/${id}/test`, sending('POST'));
  for (let look = 0; look < looks; ++look) {
    const last = (await showWebhooks()).find((webhook) => webhook.id === id)?.last;
    if (last?.outcome !== 'waiting') {
      return;
    }
    await new Promise((done) => {
      setTimeout(done, pause);
    });
  }
}

/** Attaches the handlers of the buttons in a card's rows. @param {string} rows @param {string} place  of complaints @param {Record<string, (id: string) => Promise<unknown>>} actions */
function listen(rows, place, actions) {
  element(rows).addEventListener('click', (/** @type {any} */ event) => {
    const button = event.target.closest('button');
    const row = button?.closest('[data-key]');
    if (row) {
      attempt(place, async () => {
        await actions[button.dataset.do](row.dataset.key);
      });
    }
  });
}

/** @param {string} card @param {string} place  of complaints @param {() => Promise<void>} add */
function takeNew(card, place, add) {
  element(card).addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    attempt(place, add);
  });
}

async function addPrinter() {
  const [name, kind, url, key] = ['name', 'kind', 'url', 'key'].map((field) => element(`printer-${field}`).value.trim());
  const user = kind === 'prusalink' && key !== '' ? element('printer-user').value.trim() : '';
  await json('printers', sending('POST', {name, kind, url, user, key}));
  for (const field of ['name', 'url', 'key']) {
    element(`printer-${field}`).value = '';
  }
  await showPrinters();
}

async function addWebhook() {
  await json('webhooks', sending('POST', {url: element('webhook-url').value.trim()}));
  element('webhook-url').value = '';
  await showWebhooks();
}

/** Replaces #outgoing by both cards. */
export async function prepareOutgoing() {
  await fetchFragment(element('outgoing'), 'outgoing.html');
  element('outgoing').replaceWith(...element('outgoing').childNodes);
  element('printer-kind').replaceChildren(...Object.entries(kinds).map(([kind, name]) => new Option(name, kind)));
  const seeKind = () => show(element('printer-login'), element('printer-kind').value === 'prusalink');
  element('printer-kind').addEventListener('change', seeKind);
  seeKind();
  takeNew('printers-card', 'printer-complaint', addPrinter);
  takeNew('webhooks-card', 'webhook-complaint', addWebhook);
  listen('printer-rows', 'printer-complaint', {
    remove: async (id) => {
      await withoutAnswer(`printers/${id}`, 'DELETE');
      await showPrinters();
    },
  });
  listen('webhook-rows', 'webhook-complaint', {
    test: testWebhook,
    remove: async (id) => {
      await withoutAnswer(`webhooks/${id}`, 'DELETE');
      await showWebhooks();
    },
  });
  attempt('printer-complaint', showPrinters);
  attempt('webhook-complaint', async () => {
    await showWebhooks();
  });
}
