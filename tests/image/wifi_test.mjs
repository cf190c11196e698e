// Boots the image with three simulated radios: the scanner's, a router's and a phone's. The scanner joins the router, opens a hotspot
// when the router is gone, and joins another router that the phone enters. Argument: the card's folder.

import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {promisify} from 'node:util';

import {patience, require, runTest, until} from './checks.mjs';
import {Guest, readCard, secondsSince} from './guest.mjs';
import {makeSshKey, testSettings} from './settings_test.mjs';

const card = process.argv[2];
const say = (text) => console.log(`wifi-test: ${text}`);

/** The WiFi state that the appliance gives to the daemon. @returns {Promise<Record<string, string>>} */
async function wifi(guest) {
  const lines = (await guest.run('cat /run/octurn-appliance/wifi')).split('\n');
  return Object.fromEntries(lines.map((line) => line.split(/ = ?/, 2)));
}

/** Waits for a state of the WiFi, and prints how long it took. */
async function reaches(guest, state, name) {
  const begin = performance.now();
  let answer;
  await until(`WiFi ${state} ${name}`, async () => {
    answer = await wifi(guest);
    return answer.state === state && answer.name === name;
  }).catch((error) => {
    throw new Error(`${error.message}; it is ${JSON.stringify(answer)}`);
  });
  say(`${state} ${name} after ${secondsSince(begin).toFixed(0)} s${answer.error ? `: ${answer.error}` : ''}`);
  return answer;
}

/** Restarts a radio's wpa_supplicant with another network. */
async function use(guest, radio, network) {
  await guest.run(`printf 'ctrl_interface=/run/wpa_supplicant\\nnetwork={\\n${network.join('\\n')}\\n}\\n' >/run/${radio}.conf; ` +
    `wpa_cli -i ${radio} terminate >/dev/null 2>&1; sleep 1; wpa_supplicant -B -D nl80211 -i ${radio} -c /run/${radio}.conf >/dev/null`);
}

/** Starts a router, whose DHCP gives addresses in 192.168.78; with WPA2, or with WPA3 only. */
const startRouter = (guest, name, password, keys = ['key_mgmt=WPA-PSK']) => use(guest, 'wlan2', ['mode=2', `ssid="${name}"`,
  `psk="${password}"`, ...keys, 'proto=RSN', 'pairwise=CCMP', 'frequency=2412']);
const wpa3 = ['key_mgmt=SAE', 'ieee80211w=2'];

/** The password field of every stored WiFi. */
const keptPasswords = async (guest) => (await guest.run('cut -d" " -f3 /data/wifi')).trim();

const address = (guest, radio, net) => until(`address of ${radio} in ${net}`, async () =>
  (await guest.run(`ip -4 -o address show ${radio}`)).match(new RegExp(`inet (${net}\\.\\d+)/`))?.[1]);

/** Adds simulated radios. Neither the router's nor the phone's network may become a default route. */
async function plugRadios(guest) {
  const network = (name, lines) => `printf '[Match]\\nName=${name}\\n${lines.join('\\n')}\\n' >/run/systemd/network/10-${name}.network`;
  await guest.run(['mkdir -p /run/systemd/network',
    network('wlan1', ['[Network]', 'DHCP=ipv4', '[DHCPv4]', 'UseRoutes=no', 'UseGateway=no']),
    network('wlan2', ['[Network]', 'Address=192.168.78.1/24', 'DHCPServer=yes', '[DHCPServer]', 'EmitRouter=no',
      'EmitDNS=no', 'PersistLeases=no']),
    'networkctl reload', 'modprobe mac80211_hwsim radios=3'].join('; '));
  await until('radios', () => guest.run('[ -e /sys/class/net/wlan2 ] && echo yes'));
}

/** Routes traffic between phone and scanner over the air, although both are this machine. */
async function separate(guest, phone) {
  await guest.run(['for name in all wlan0 wlan1; do echo 1 >/proc/sys/net/ipv4/conf/$name/accept_local; ' +
    'echo 0 >/proc/sys/net/ipv4/conf/$name/rp_filter; done',
    'ip rule add pref 1 iif wlan0 lookup local', 'ip rule add pref 1 iif wlan1 lookup local',
    `ip route add 192.168.77.1 dev wlan1 src ${phone} table 71`, 'ip rule add pref 2 to 192.168.77.1 iif lo lookup 71',
    `ip route add ${phone} dev wlan0 src 192.168.77.1 table 72`, `ip rule add pref 2 to ${phone} iif lo lookup 72`,
    'ip rule add pref 3 lookup local', 'ip rule del pref 0'].join('; '));
}

/** Reverts `separate`. */
const unite = (guest) => guest.run('ip rule add pref 0 lookup local; ' +
  'for rule in 1 1 2 2 3; do ip rule del pref $rule; done; ip route flush table 71; ip route flush table 72');

/** The scanner's response to a phone that requests a path of any host. @param {string} filter  a command to filter the response */
const askByAir = (guest, host, path, filter) => guest.run('timeout 300 bash -c "exec 3<>/dev/tcp/192.168.77.1/80; ' +
  `printf 'GET ${path} HTTP/1.1\\r\\nHost: ${host}\\r\\nConnection: close\\r\\n\\r\\n' >&3; cat <&3" | ${filter}`);

/** A phone's connectivity check finds the page: through the name server of its lease, and through the captive portal. */
async function testPortal(guest) {
  const [host, path] = ['captive.apple.com', '/hotspot-detect.html'];
  const found = await guest.run(`resolvectl query --interface=wlan1 --cache=no ${host}`);
  require(found.startsWith(`${host}: 192.168.77.1 `), `a phone that asks for ${host} is told ${found}`);
  const answer = await askByAir(guest, host, path, 'head -n 20');
  require(/^HTTP\/1.1 302 /.test(answer) && answer.includes('Location: http://192.168.77.1/'), `${host} answers ${answer}`);
  say(`a phone that asks for ${host} is led to the page`);
}

async function testHotspot(guest, hotspot) {
  await use(guest, 'wlan1', [`ssid="${hotspot}"`, 'key_mgmt=NONE']);
  const phone = await address(guest, 'wlan1', '192.168.77');
  await separate(guest, phone);
  const received = async () => Number(await guest.run('cat /sys/class/net/wlan1/statistics/rx_bytes'));
  const before = await received();
  const page = await askByAir(guest, '192.168.77.1', '/', 'wc -c');
  const through = await received() - before;
  require(Number(page) > 1000 && through > Number(page), `of the page there are ${page} bytes, and ${through} came by air`);
  const names = await guest.run('journalctl -b -u avahi-daemon -o cat | grep -c "interface wlan0.IPv4 with address 192.168.77.1"');
  require(Number(names) > 0, 'avahi answers nobody in the hotspot');
  say(`a phone in ${hotspot} gets the address ${phone} and the page of ${page} bytes`);
  await testPortal(guest);
}

/** Requests a WiFi like the daemon does. */
async function request(guest, name, password) {
  await guest.run('setpriv --reuid=octurn --regid=octurn --clear-groups sh -c "umask 077; cd /run/octurn-appliance/requests; ' +
    `printf 'wifi_name = ${name}\\nwifi_password = ${password}\\nwifi_country = DE\\n' >.wifi; mv .wifi wifi"`);
}

async function testWifi(guest) {
  await guest.run('export LD_LIBRARY_PATH=/usr/lib/octurn/lib');  // `ip` needs it, as in the image's `status`
  await plugRadios(guest);
  await startRouter(guest, 'IEEE', 'password');
  await reaches(guest, 'joined', 'IEEE');
  say(`its address there is ${await address(guest, 'wlan0', '192.168.78')}`);
  await until('IEEE among the networks', async () =>
    /^bssid .*\n[^]*\[WPA2-PSK-CCMP\].*\tIEEE$/m.test(await guest.run('cat /run/octurn-appliance/networks')));

  await guest.run('wpa_cli -i wlan2 terminate; ip link set eth0 down');
  const {hotspot, error} = await reaches(guest, 'hotspot', 'IEEE');
  require(/^Octurn-[0-9A-F]{4}$/.test(hotspot), `the hotspot is ${hotspot}`);
  require(error.includes('IEEE was not found'), `the error is ${error}`);
  await testHotspot(guest, hotspot);

  await guest.run('wpa_cli -i wlan1 terminate');
  await startRouter(guest, 'IEEE', 'password');
  await reaches(guest, 'joined', 'IEEE');  // retried, as no client is in the hotspot
  const names = await guest.run('systemctl is-active octurn-names');
  require(names === 'inactive', `outside of the hotspot octurn-names is ${names}`);
  await guest.run('wpa_cli -i wlan2 terminate');
  await reaches(guest, 'hotspot', 'IEEE');

  await startRouter(guest, 'Workshop', 'right password');
  await request(guest, 'Workshop', 'wrong password');
  await reaches(guest, 'joining', 'Workshop');
  const refused = await reaches(guest, 'hotspot', 'Workshop');
  require(refused.error.includes('Is the password right?'), `the error is ${refused.error}`);
  await request(guest, 'Workshop', 'right password');
  await reaches(guest, 'joined', 'Workshop');
  await address(guest, 'wlan0', '192.168.78');
  await until('no password kept that WPA2 does not need', async () => await keptPasswords(guest) === '');

  await guest.run('wpa_cli -i wlan2 terminate');
  await reaches(guest, 'hotspot', 'Workshop');
  await startRouter(guest, 'Museum', 'guided tour', wpa3);
  await request(guest, 'Museum', 'guided tour');
  await reaches(guest, 'joined', 'Museum');
  await address(guest, 'wlan0', '192.168.78');
  const key = await guest.run('wpa_cli -s /run -i wlan0 status | grep ^key_mgmt');
  require(key === 'key_mgmt=SAE', `the scanner has joined with ${key}`);
  require(await keptPasswords(guest) !== '', 'WPA3 needs the password again at the next start');
  say('a router with WPA3 alone is joined');
  const left = await guest.run('ip -4 -o address show wlan0 | grep -c 192.168.77.1');
  require(left === '0', 'the hotspot\'s address is still there');
  await unite(guest);
  await guest.run('ip link set eth0 up');
  await guest.page(patience);
  say('by cable, too, when that is plugged in again');
}

/** Checks octurn.txt on the card after these changes. */
async function testCard(guest) {
  const settings = await readCard(card, 'octurn.txt');
  for (const line of ['wifi_name = Museum', 'wifi_password = ********', 'wifi_country = DE', 'rig = simulated']) {
    require(settings.split('\n').includes(line), `octurn.txt lacks "${line}":\n${settings}`);
  }
  require(!/IEEE|sesame|right password|guided tour/.test(settings), `octurn.txt is\n${settings}`);
  const errors = await guest.run('setpriv --reuid=octurn --regid=octurn --clear-groups cat /run/octurn-appliance/errors');
  require(/^--- octurn [^]*IEEE was not found/m.test(errors), `of errors is kept\n${errors}`);
  await guest.run('yes old | head -n 20000 >>/data/errors; systemd-cat -t octurn -p warning echo the newest');
  await until('the newest error, and few before it', async () => {
    const [bytes, newest] = (await guest.run('stat -c %s /data/errors; tail -n 1 /data/errors')).split('\n');
    return Number(bytes) < 65536 && newest?.endsWith('the newest');
  });
  const failed = await guest.run('systemctl --failed --plain --no-legend | cut -d" " -f1 | paste -sd" " -');
  require(failed === '', `failed units: ${failed}`);
  say('octurn.txt has the WiFi of the page, and stars; what went wrong is kept; no failed unit');
}

const key = makeSshKey();
await writeFile(`${card}/octurn.txt`, ['rig = simulated', 'wifi_name = IEEE', 'wifi_password = password', 'wifi_country = DE',
  'time_zone = Europe/Berlin', `ssh_key = ${key.line}`, ''].join('\n'));
await promisify(execFile)('mcopy', ['-o', '-i', `${card}/card.img@@1M`, `${card}/octurn.txt`, '::octurn.txt']);
const guest = await Guest.start('virt', card);
await runTest('wifi-test', () => guest, async () => {
  say(`the page after ${(await guest.page(patience)).toFixed(1)} s`);
  await testSettings(guest, key, say);
  await testWifi(guest);
  await testCard(guest);
});
