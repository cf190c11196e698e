// Boots the image, scans in it, and prints times and memory. Arguments: the machine, the card's folder, and the number of power cuts
// after that.

import {open, readFile} from 'node:fs/promises';

import {measure} from '../web/mesh_file.js';
import {patience as patienceOfVirt, require, runTest, until} from './checks.mjs';
import {Guest, readCard, secondsSince} from './guest.mjs';
import {requireKept, setWhatIsKept} from './kept.mjs';
import {cutPower} from './power_cuts.mjs';

const [machine, card, cuts] = process.argv.slice(2);
const patience = machine === 'virt' ? patienceOfVirt : 900;

// IEEE 802.11's example of a password and the key made of it, annex J.4.1
const wifi = {password: 'password', key: 'f42c6fc52df0ebef9ebb4b90b38a5f902e83fe1b135a70e23aed762e9710a12e'};

const imagesSignature = '4f637475';  // of layout.sh

const say = (text) => console.log(`boot-test: ${text}`);

async function scan(guest) {
  const {id} = await guest.startScan({snapshots: 8, frames: 3, leaf_size_mm: 2}, patience);
  const begin = performance.now();
  const {state, error, model} = await until('the scan', async () => {
    const scan = await guest.ask(`scans/${id}`);
    return scan.state !== 'running' && scan;
  }, patience);
  require(state === 'finished', `the scan ${state}: ${JSON.stringify(error)}`);
  return {seconds: secondsSince(begin), model};
}

async function testScan(guest) {
  const {seconds, model} = await scan(guest);
  const response = await fetch(`${guest.url}Scan.stl`, {signal: AbortSignal.timeout(1000 * patience)});
  const mesh = measure(Buffer.from(await response.arrayBuffer()));
  require(mesh.triangles > 1000, `the model has ${mesh.triangles} triangles`);
  require(mesh.openEdges === 0, `the model has ${mesh.openEdges} open edges`);
  require(mesh.volume > 0, 'the model is inside out');
  require(model.watertight, 'the daemon does not call its model watertight');
  say(`a scan of 8 snapshots in ${seconds.toFixed(1)} s: ${mesh.triangles} triangles, closed, ${(mesh.volume / 1000).toFixed(1)} cm3`);

  const bytes = Number(await guest.run('cat /sys/fs/cgroup/system.slice/octurn.service/memory.peak', patience));
  require(bytes > 1e6, 'the daemon has no memory');
  const peak = await guest.run('sed -n "s/^VmHWM:[^0-9]*//p" /proc/$(systemctl show -P MainPID octurn)/status');
  say(`the daemon's peak memory: ${peak} resident, ${(bytes / 1048576).toFixed(0)} MiB with its files in the cache`);
}

async function testDoctor(guest) {
  const {state, findings} = await guest.ask('doctor');
  require(findings.length > 5, `the doctor has only ${findings.length} findings`);
  const bad = findings.filter((finding) => finding.state !== 'ok').map(({state, name, measured}) => `${state} ${name}: ${measured}`);
  require(state !== 'fault', `the doctor finds ${bad.join('; ')}`);
  say(`octurn doctor: ${state}, ${findings.length} findings; not ok: ${bad.join('; ') || 'none'}`);
}

async function testSystem(guest) {
  // The name announced in the network is avahi's, which differs from the hostname after a conflict.
  const name = await guest.run('cat /proc/sys/kernel/hostname; busctl call org.freedesktop.Avahi / org.freedesktop.Avahi.Server GetHostName');
  require(/^boot-test\s+s "boot-test"$/.test(name), `octurn.txt gives the name boot-test, and it is ${name}`);
  const kept = await guest.run('stat -c %a /data/wifi; cat /data/wifi');
  // The password is kept until the scanner has joined by WPA2, as WPA3 would need it. This machine has no WiFi to join.
  const password = Buffer.from(wifi.password).toString('hex');
  require(kept === `600\n49454545 ${wifi.key} ${password}`, `of the WiFi is kept: ${kept}`);
  const used = await guest.run('grep -o psk=.* /etc/wpa_supplicant/wpa_supplicant-wlan0.conf | sort -u');
  require(used === `psk=${wifi.key}`, `wpa_supplicant's key is ${used}`);
  const size = Number(await guest.run('df --output=size -m /var/lib/octurn | tail -n 1'));
  require(size > 200, `the data partition has not grown: ${size} MiB`);
  const failed = await guest.run('systemctl --failed --plain --no-legend | cut -d" " -f1 | paste -sd" " -');
  require(failed === '', `failed units: ${failed}`);
  const restarts = await guest.run('systemctl show -P NRestarts octurn');
  require(restarts === '0', `the daemon has been restarted ${restarts} times`);
  const errors = await guest.run('journalctl -b -q -p err --no-pager -o cat | head -n 20');
  say(`data partition of ${size} MiB, no failed units, errors in the journal: ${errors || 'none'}`);
}

/** Stores the settings for which the tests of power cuts and updates look again. */
async function testKept(guest) {
  await setWhatIsKept(guest);
  await guest.run('systemctl restart octurn', patience);
  await guest.page(patience);
  await requireKept(guest);
  say('setting, pose and sensor map are kept when the daemon starts again');
}

/** Waits for a file on the card, which appears only when it is complete. */
const cardHas = (name) => until(`${name} on the card`, () => readCard(card, name).catch(() => ''), patience);

/** @returns {Promise<Buffer>} the first bytes of a file */
async function readFirst(name, length) {
  const file = await open(name);
  try {
    return (await file.read({buffer: Buffer.alloc(length), position: 0})).buffer;
  } finally {
    await file.close();
  }
}

/** Checks the files that the scanner's owner sees on the card in another computer. */
async function testCard(version) {
  const settings = await readCard(card, 'octurn.txt');
  const given = await readFile(`${card}/octurn.txt`, 'utf8');
  require(settings === given.replace(`= ${wifi.password}`, '= ********'), `octurn.txt is\n${settings}`);
  const status = await readCard(card, 'octurn-status.txt');
  for (const line of ['The page: http://boot-test.local', 'http://10.0.2.15', `Octurn ${version}`, 'there is no setting colour']) {
    require(status.includes(line), `octurn-status.txt lacks "${line}":\n${status}`);
  }
  const signature = (await readFirst(`${card}/card.img`, 444)).readUInt32LE(440).toString(16).padStart(8, '0');
  const line = await readCard(card, 'a/cmdline.txt');
  require(signature !== imagesSignature && line.startsWith(`octurn.disk=${signature} `),
    `the card's signature is ${signature}, and the kernel's command line is ${line}`);
  say('on the card: octurn.txt without the password, octurn-status.txt with address and the wrong line, a signature of its own');
}

async function test(guest) {
  const seconds = await guest.page(patience);
  say(`${machine}: the page after ${seconds.toFixed(1)} s, ${(await guest.processorSeconds()).toFixed(1)} s of processor time`);
  const {version, sensor} = await guest.ask('status');
  require(sensor.simulated, `octurn.txt asks for the simulated rig, and the sensor is ${JSON.stringify(sensor)}`);
  say(`octurn ${version}, on the simulated rig as octurn.txt asks`);
  await testScan(guest);
  await testDoctor(guest);
  await testSystem(guest);
  await testKept(guest);
  await cardHas('octurn-status.txt');
  await guest.run('sync');
  await guest.cutPower();
  await testCard(version);
}

let guest = await Guest.start(machine, card);
await runTest('boot-test', () => guest, async () => {
  await test(guest);
  guest = await Guest.start(machine, card);
  await guest.page(patience);
  await requireKept(guest);
  await guest.cutPower();
  say('setting, pose and sensor map are kept when the plug is pulled');
  if (Number(cuts) > 0) {
    await cutPower(machine, card, Number(cuts), patience, say);
  }
});
