// Updates and WiFi, on an appliance's page.

import * as api from '../api/api.js';
import {element, setText, show} from '../base/dom.js';
import {awaitFragment} from '../base/fragment.js';
import {tabOf} from '../places.js';
import {text} from '../base/texts.js';

const usual = {title: text('away.title'), text: text('away.text')};

let isAppliance = false;
let isScanning = false;
let version = '';  // the page's own version
/** @type {(typeof import('./update.js') & typeof import('./wifi.js')) | null} null until its fragment is loaded */
let parts = null;
let wake = () => {};

/** @param {import('../api/api.js').Status} status */
export function seeStatus({appliance, scan}) {
  isAppliance = appliance;
  isScanning = scan !== null;
  parts?.showScanning(isScanning);
}

async function prepare() {
  const [update, wifi] = await Promise.all([import('./update.js'), import('./wifi.js'), awaitFragment(element('appliance'), 'appliance.html')]);
  update.prepareUpdate();
  wifi.prepareWifi();
  parts = {...update, ...wifi};
  parts.showScanning(isScanning);
}

/**
 * Whether the fragment is needed: it is in view, or something goes on that other places show, too.
 * @param {import('../api/api.js').Update} update @param {import('../api/api.js').Wifi} wifi
 */
const isNeeded = (update, wifi) => tabOf(location.hash.slice(1)) === 'scanner' || ['hotspot', 'joining'].includes(wifi.state) ||
    ['receiving', 'installing', 'restarting', 'trial'].includes(update.state);

/** Explains in the banner why the scanner does not answer, which may be expected. */
function explainAway() {
  const {title, text: detail} = parts?.updateAway() ?? parts?.wifiAway() ?? usual;
  setText(element('away-title'), title);
  setText(element('away-text'), detail);
}

async function look() {
  try {
    const [update, wifi] = await Promise.all([api.update(), api.wifi()]);
    if (version && version !== update.version) {
      location.reload();  // the page is older than the scanner's program
    }
    version = update.version;
    if (!parts && isNeeded(update, wifi)) {
      await prepare();
    }
    parts?.showUpdate(update);
    parts?.showWifi(wifi);
    show(element('appliance'), parts !== null);
    parts && show(element('wifi'), true);
  } catch {
    parts?.showUpdateAway();
  }
  explainAway();
}

/** Polls updates and WiFi as long as the page is open. */
export async function watchAppliance() {
  addEventListener('hashchange', () => parts || wake());
  for (;;) {
    if (isAppliance && !document.hidden) {
      await look();
    }
    const pause = version && !parts?.isUpdating() && !parts?.isJoining() ? 3000 : 1000;
    await new Promise((/** @type {(value?: undefined) => void} */ done) => {
      wake = done;
      setTimeout(done, pause);
    });
  }
}
