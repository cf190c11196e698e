// "Send to printer" below a model's download, if the scanner has printers.

import {Problem, json, sending} from '../api/api.js';
import {element, setText, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {text} from '../base/texts.js';

/**
 * @typedef {Object} Upload
 * @property {string} printer
 * @property {'sending' | 'sent' | 'failed' | 'cancelled'} state
 * @property {number} progress
 * @property {string} detail
 * @property {string} hint
 * @property {string} fingerprint  of a certificate that can be trusted; empty: none can
 */

const pause = 500;  // milliseconds between polls

/** The state of an upload in words. Pure. @param {Upload} upload */
export function aboutUpload({printer, state, progress, detail, hint}) {
  const words = {
    sending: () => text('send.sending', {printer, percent: Math.floor(progress * 100)}),
    sent: () => text('send.sent', {printer}),
    failed: () => [detail, hint].map(sentence).join(' '),
    cancelled: () => text('send.cancelled'),
  };
  return words[state]();
}

/** The scan whose model the link downloads. Pure. @param {string} href */
export const scanIn = (href) => /scans\/([^/]+)\//.exec(href)?.[1] ?? '';

/** @param {string} words @param {'good' | 'bad' | ''} tone */
function say(words, tone) {
  setText(element('send-said'), words);
  element('send-said').dataset.tone = tone;
  show(element('send-trust'), false);
}

/** @type {() => Promise<void>} */
let trust = async () => {};  // what "Trust it and send" does first

const shownScan = () => scanIn(element('download').getAttribute('href') ?? '');

/** Polls an upload until its end, or until another scan is in view. @param {string} id */
async function follow(id) {
  for (;;) {
    const upload = /** @type {Upload} */ (await json(`scans/${id}/send`));
    if (shownScan() !== id) {
      return;
    }
    say(aboutUpload(upload), upload.state === 'sent' ? 'good' : upload.state === 'failed' ? 'bad' : '');
    if (upload.state !== 'sending') {
      offerTrust(upload);
      return;
    }
    await new Promise((done) => {
      setTimeout(done, pause);
    });
  }
}

/** Offers to trust a certificate that no authority has signed. @param {Upload} upload */
function offerTrust({fingerprint}) {
  const printer = element('send-printer').value;
  trust = async () => {
    await json(`printers/${printer}`, sending('PATCH', {fingerprint}));
  };
  show(element('send-trust'), fingerprint !== '');
}

/** @param {() => Promise<void>} [first] */
async function send(first = async () => {}) {
  const id = shownScan();
  const button = element('send-start');
  if (button.getAttribute('aria-disabled') === 'true') {
    return;
  }
  button.setAttribute('aria-disabled', 'true');
  try {
    await first();
    await json(`scans/${id}/send`, sending('POST', {printer: element('send-printer').value}));
    await follow(id);
  } catch (error) {
    const {detail, title, hint} = error instanceof Problem ? error : new Problem('page', String(error));
    say([detail || title, hint].map(sentence).join(' ').trim(), 'bad');
  } finally {
    button.removeAttribute('aria-disabled');
  }
}

let asked = '';  // the scan for which the printers were fetched

/** Offers the printers when another model is shown. */
async function offer() {
  const id = shownScan();
  if (element('download').hidden || id === '') {
    show(element('send'), false);
  } else if (id !== asked) {
    asked = id;
    say('', '');
    const {printers} = await json('printers').catch(() => ({printers: []}));
    const chosen = element('send-printer').value;
    element('send-printer').replaceChildren(...printers.map((/** @type {{id: string, name: string}} */ printer) => new Option(printer.name, printer.id)));
    element('send-printer').value = printers.some((/** @type {{id: string}} */ printer) => printer.id === chosen) ? chosen : printers[0]?.id ?? '';
    show(element('send'), printers.length > 0);
  } else {
    show(element('send'), element('send-printer').options.length > 0);
  }
}

export function prepareSend() {
  element('send').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    send();
  });
  element('send-trust').addEventListener('click', () => send(trust));
  new MutationObserver(offer).observe(element('download'), {attributes: true, attributeFilter: ['href', 'hidden']});
  addEventListener('hashchange', () => {
    asked = '';  // printers may have been added meanwhile
    offer();
  });
  offer();
}
