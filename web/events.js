// The scanner's news as it tells them by itself, so that the page need not ask. Where there are none, the page asks.

/** @typedef {import('./api.js').Status} Status */

const address = '/api/v1/events';
const maxSilence = 5000;  // milliseconds; a heartbeat comes every 3 s
const retryPause = 30000;  // milliseconds, as Retry-After of a scanner that too many watch already
const overtaking = 1000;  // milliseconds in which a status from before an answer may still arrive after it

/** The status that the scanner told last. Pure: times are given, milliseconds. */
export class HeardStatus {
  /** @type {Status | null} */
  #status = null;
  #heard = -Infinity;
  #trusted = -Infinity;  // from when on

  /** @param {Status} status @param {number} now */
  hear(status, now) {
    this.#status = now >= this.#trusted ? status : null;
    this.#heard = now;
  }

  /** The scanner is there, and nothing has changed. @param {number} now */
  hearBeat(now) {
    this.#heard = now;
  }

  /** Something was asked of the scanner: what was told before is old. @param {number} now */
  distrust(now) {
    this.#status = null;
    this.#trusted = now + overtaking;
  }

  forget() {
    this.#status = null;
  }

  /** @param {number} now @returns {Status | null} nothing if it may be old */
  at(now) {
    return now - this.#heard <= maxSilence ? this.#status : null;
  }
}

const heard = new HeardStatus();
let asked = 0;
/** @type {EventSource | null} */
let source = null;

/** The status that the scanner told, if it is of now. @param {number} asks  of the scanner so far @returns {Status | null} */
export function told(asks) {
  if (asks !== asked) {
    asked = asks;
    heard.distrust(performance.now());
  }
  return heard.at(performance.now());
}

/** What was asked for in place of news: it counts as told, as long as there are news. @param {Status} status */
export const note = (status) => source?.readyState === EventSource.OPEN && heard.hear(status, performance.now());

/**
 * Listens for as long as the page is in sight: a browser has six connections for all its pages of one scanner.
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
      heard.hear(JSON.parse(data), performance.now());
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
