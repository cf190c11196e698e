// Installs updates over the HTTP interface, and checks which system runs after each. Arguments: the machine, the card's folder, and
// the folder with the updates good, dying, short, older and strange, and with stick.img.

import {openAsBlob} from 'node:fs';
import {setTimeout as sleep} from 'node:timers/promises';

import {patience, require, runTest, until} from './checks.mjs';
import {Guest, secondsSince} from './guest.mjs';
import {requireKept} from './kept.mjs';

const [machine, card, updates] = process.argv.slice(2);

const say = (text) => console.log(`update-test: ${text}`);

let guest;
let scans;

/** Boots the machine. */
const start = async (stick) => {
  guest = await Guest.start(machine, card, stick);
  return guest.page(patience);
};
const send = async (name) => {
  const response = await fetch(`${guest.url}api/v1/update`, {
    method: 'PUT', headers: {'Content-Type': 'application/octet-stream'}, body: await openAsBlob(`${updates}/${name}`),
    signal: AbortSignal.timeout(patience * 1000)});
  require(response.status === 202, `the update "${name}": ${response.status} ${await response.text()}`);
};
/** Waits for a state of the update. */
const reaches = (state) => until(`update ${state}`, async () => {
  const update = await guest.ask('update');
  return update.state === state && update;
});
const storedScans = async () => JSON.stringify((await guest.ask('scans')).scans.map(({id, snapshots_done}) => [id, snapshots_done]));
/** Checks that the system of this slot serves the page, with every scan and setting. */
const isOn = async (slot) => {
  const update = await until('which system runs', async () => {
    const answer = await guest.ask('update');
    return answer.slot && answer;
  });
  require(update.slot === slot, `the system is not ${slot}: ${JSON.stringify(update)}`);
  const line = await guest.run('cat /proc/cmdline; cat /proc/sys/kernel/hostname');
  require(line.includes(`octurn.slot=${slot}`) && line.endsWith('boot-test'), `the system that runs is: ${line}`);
  require(await storedScans() === scans, `the scans were ${scans}, and are ${await storedScans()}`);
  await requireKept(guest);
};

const refuses = async (name, reason) => {
  await send(name);
  const {error} = await reaches('failed');
  require(error.includes(reason), `the update "${name}" is refused: ${error}`);
  await isOn('a');
  say(`update "${name}" refused: ${error}`);
};
const losesPower = async () => {
  await send('good');
  await reaches('installing');
  await sleep(Math.random() * 4000);
  await guest.cutPower();
  await start();
  await isOn('a');
  say('power cut while an update was written: the system before it is back');
};
const goesBack = async () => {
  await send('dying');
  const begin = performance.now();
  await guest.restarts(patience);  // into the update
  guest = await Guest.start(machine, card);
  await guest.restarts(patience);  // as its daemon dies
  guest = await Guest.start(machine, card);
  await guest.restarts(patience);  // as an update is tried only once
  await start();
  const {error} = await reaches('returned');
  await isOn('a');
  say(`update "dying": the system before it is back ${secondsSince(begin).toFixed(0)} s later: ${error}`);
};
/** Runs `octurn update` in a shell on the scanner, with the uploaded file. */
const keeps = async () => {
  await guest.run('systemctl mask --runtime --now octurn-update.path');  // it may not have started yet
  await send('good');
  const begin = performance.now();
  await guest.run('{ octurn update /run/octurn-appliance/requests/update >/run/update.log 2>&1 & }');
  await guest.restarts(patience);
  const seconds = await start();
  await reaches('kept');
  await isOn('b');
  say(`update "good": its page after ${seconds.toFixed(1)} s, kept after ${secondsSince(begin).toFixed(0)} s`);
  await guest.cutPower();
  await start();
  await isOn('b');
  say('after a power cut the update still runs');
};

const comesByStick = async () => {
  const stick = `${updates}/stick.img`;
  await guest.cutPower();
  await start(stick);
  const begin = performance.now();
  await guest.restarts(patience);
  await start(stick);
  const {update_version: version} = await reaches('kept');
  require(version === '99.0.0', `the update of the stick is ${version}`);
  await isOn('a');
  const unit = 'systemctl list-units --all --plain --no-legend "octurn-stick@*"';
  const ended = await until('the look at the stick', async () => {
    const units = await guest.run(unit);
    return !units.includes('activating') && guest.run('journalctl -b -o cat -u "octurn-stick@*"');
  });
  require(!ended.includes('installing'), `the stick's update is installed again: ${ended}`);
  say(`update of a USB stick: kept after ${secondsSince(begin).toFixed(0)} s, and not installed again`);
};

await runTest('update-test', () => guest, async () => {
  await start();
  scans = await storedScans();
  await refuses('strange', 'not signed');
  await refuses('short', 'cut short');
  await refuses('older', 'which is older than');
  await losesPower();
  await goesBack();
  await keeps();
  await comesByStick();
});
