// "Name and time" on the settings page of an appliance.

import {Problem, status} from '../api/api.js';
import * as api from '../api/api_settings.js';
import {element, setText, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api_settings.js').Machine} Machine */

const pause = 500;  // milliseconds between polls
const patience = 20;  // polls until a change counts as failed

/** Why a host name is invalid, or an empty text. Pure. @param {string} name */
export const nameComplaint = (name) => /^[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?$/i.test(name) ? '' :
  text('machine.name-shape');

/** The change to send to the scanner. Pure. @param {Machine} machine @param {string} name @param {string} zone */
export function changeOf({name: present, time_zone}, name, zone) {
  const wanted = name.toLowerCase();
  return {...(wanted === present ? {} : {name: wanted}), ...(zone === time_zone ? {} : {time_zone: zone})};
}

/** Whether the scanner has made the change, or reports an error. Pure. @param {Machine} machine @param {{name?: string, time_zone?: string}} wanted */
export const isAnswered = (machine, wanted) => machine.error !== '' ||
  (wanted.name ?? machine.name) === machine.name && (wanted.time_zone ?? machine.time_zone) === machine.time_zone;

/** @type {Machine} */
let machine = {name: '', time_zone: '', error: ''};

const wanted = () => changeOf(machine, element('machine-name').value.trim(), element('machine-zone').value);

function showChanged() {
  show(element('machine-save'), Object.keys(wanted()).length > 0);
  setText(element('machine-address'), text('machine.address', {address: `http://${element('machine-name').value.trim().toLowerCase()}.local`}));
}

function offerZones() {
  const zones = Intl.supportedValuesOf('timeZone');
  const all = zones.includes(machine.time_zone) ? zones : [machine.time_zone, ...zones];
  element('machine-zone').replaceChildren(...all.map((zone) => new Option(zone || 'UTC', zone)));
}

function fill() {
  element('machine-name').value = machine.name;
  offerZones();
  element('machine-zone').value = machine.time_zone;
  showChanged();
}

/** @param {unknown} error */
function complain(error) {
  const {title, detail, hint} = error instanceof Problem ? error : new Problem('page', String(error));
  setText(element('machine-complaint'), [detail || title, hint].map(sentence).join(' '));
}

/** Requests a change, which a root service makes later. @param {{name?: string, time_zone?: string}} change */
async function save(change) {
  await api.changeMachine(change);
  for (let look = 0; look < patience; ++look) {
    await new Promise((done) => {
      setTimeout(done, pause);
    });
    machine = await api.machine();
    if (isAnswered(machine, change)) {
      break;
    }
  }
  setText(element('machine-complaint'), sentence(machine.error));
  setText(element('machine-saved'), machine.error ? '' : text('saved'));
  fill();
}

/** Shows the card on an appliance. */
export async function prepareMachine() {
  const card = element('machine-card');
  card.addEventListener('input', () => {
    setText(element('machine-saved'), '');
    showChanged();
  });
  card.addEventListener('submit', async (/** @type {Event} */ event) => {
    event.preventDefault();
    const complaint = nameComplaint(element('machine-name').value.trim());
    setText(element('machine-complaint'), complaint);
    if (!complaint) {
      await save(wanted()).catch(complain);
    }
  });
  if (!(await status().catch(() => null))?.appliance) {
    return;
  }
  try {
    machine = await api.machine();
    fill();
    show(card, true);
  } catch (error) {
    complain(error);
  }
}
