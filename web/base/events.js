// The scanner's event stream, which spares the page polling. Without the stream the page polls.

import {parse, root} from './address.js';

/** @typedef {import('../api/api.js').Status} Status */

const address = `${root}events`;
const maxSilence = 5000;  // milliseconds; there is a heartbeat every 3 s
const retryPause = 30000;  // milliseconds, the Retry-After of a scanner with too many streams
const longestDelay = 1000;  // milliseconds in which an older status may still arrive after a response

/** The last status from the event stream. Pure: times are arguments, milliseconds. */
export class HeardStatus {
  /** @type {Status | null} */
  #status = null;
  #heard = -Infinity;
  #trusted = -Infinity;  // statuses are valid from this time on

  /** @param {Status} status @param {number} now */
  hear(status, now) {
    this.#status = now >= this.#trusted ? status : null;
    this.#heard = now;
  }

  /** Handles a heartbeat: the scanner is there, and nothing has changed. @param {number} now */
  hearBeat(now) {
    this.#heard = now;
  }

  /** Invalidates statuses from before a request. @param {number} now */
  distrust(now) {
    this.#status = null;
    this.#trusted = now + longestDelay;
  }

  forget() {
    this.#status = null;
  }

  /** @param {number} now @returns {Status | null} null if it may be outdated */
  at(now) {
    return now - this.#heard <= maxSilence ? this.#status : null;
  }
}

const heard = new HeardStatus();
let asked = 0;
/** @type {EventSource | null} */
let source = null;

/** The last status from the stream, if it is current. @param {number} asks  requests to the scanner so far @returns {Status | null} */
export function news(asks) {
  if (asks !== asked) {
    asked = asks;
    heard.distrust(performance.now());
  }
  return heard.at(performance.now());
}

/** Takes a polled status as the stream's last one, while the stream is open. @param {Status} status */
export const note = (status) => source?.readyState === EventSource.OPEN && heard.hear(status, performance.now());

/**
 * Listens to the stream while the page is visible, as a browser has only six connections to one scanner for all its pages.
 * @param {() => void} onNews
 */
export function listenForNews(onNews) {
  let retry = 0;
  const close = () => {
    clearTimeout(retry);
    source?.close();
    source = null;
    heard.forget();
  };
  const open = () => {
    close();
    source = new EventSource(address);
    source.addEventListener('status', ({data}) => {
      heard.hear(parse(data), performance.now());
      onNews();
    });
    source.addEventListener('heartbeat', () => heard.hearBeat(performance.now()));
    source.addEventListener('error', () => {
      heard.forget();
      onNews();
      if (source?.readyState === EventSource.CLOSED) {
        retry = setTimeout(open, retryPause);
      }
    });
  };
  document.addEventListener('visibilitychange', () => document.hidden ? close() : open());
  addEventListener('pagehide', close);
  if (!document.hidden) {
    open();
  }
}
