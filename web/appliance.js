// Updates and WiFi, which the page has where it is the appliance's.

import * as api from './api.js';
import {element, setText, show} from './dom.js';
import {awaitFragment} from './fragment.js';
import {text} from './texts.js';
import {isUpdating, prepareUpdate, showScanning, showUpdate, showUpdateAway, updateAway} from './update.js';
import {isJoining, prepareWifi, showWifi, wifiAway} from './wifi.js';

const usual = {title: text('away.title'), text: text('away.text')};

let isAppliance = false;
let isPrepared = false;  // its part of the page is there

/** @param {import('./api.js').Status} status */
export function seeStatus({appliance, scan}) {
  isAppliance = appliance;
  if (isPrepared) {
    showScanning(scan !== null);
  }
}

async function prepare() {
  await awaitFragment(element('appliance'), 'appliance.html');
  prepareUpdate();
  prepareWifi();
  isPrepared = true;
}

/** What the banner says when the scanner does not answer: that may be as it should. */
function explainAway() {
  const {title, text: detail} = updateAway() ?? wifiAway() ?? usual;
  setText(element('away-title'), title);
  setText(element('away-text'), detail);
}

async function look() {
  try {
    const [update, wifi] = await Promise.all([api.update(), api.wifi()]);
    showUpdate(update);
    showWifi(wifi);
    show(element('wifi'), true);
    show(element('appliance'), true);
  } catch {
    showUpdateAway();
  }
  explainAway();
}

/** Looks again and again, for as long as the page is open. */
export async function watchAppliance() {
  for (;;) {
    if (isAppliance && !document.hidden) {
      await (isPrepared || prepare());
      await look();
    }
    const pause = isPrepared && !isUpdating() && !isJoining() ? 3000 : 1000;
    await new Promise((done) => {
      setTimeout(done, pause);
    });
  }
}
