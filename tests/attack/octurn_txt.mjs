// octurn_txt FILES [SEED]: the appliance's programs apply FILES random files octurn.txt to a folder that replaces /. Each must succeed, what they
// write must be as wpa_supplicant, dropbear and Octurn read it, no text is executed, and no password is repeated.

import {spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

import {damagedBytes} from './damage.mjs';
import {argument, filesBelow, makeFolder, require} from './daemon.mjs';
import {makeRandom} from './random.mjs';

const files = argument(0, 30);
const seed = argument(1, 20261128);
const random = makeRandom(seed);
const folder = makeFolder();
const root = join(folder, 'root');
const repository = join(dirname(fileURLToPath(import.meta.url)), '../..');
const programs = join(repository, 'image-build/root/usr/lib/octurn');
const secret = 'do-not-repeat';
const key = 'ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789abcdefg me';
const pwned = join(folder, 'pwned');
const traps = [`$(touch ${pwned})`, `\`touch ${pwned}\``, `"; touch ${pwned}; "`, `'; touch ${pwned}; '`, `|touch ${pwned}`, '\\', '%s%n', '&', '-n', '--', '*',
  '{', '}', '"', '\u0000', '\u0001', 'é', 'x'.repeat(300), '..', '/etc/passwd', '=', '#', '\t', `\n network={`, '\r', '$IFS'];
const values = {
  name: ['workshop', 'UPPER', '-n', 'a-', ''], wifi_name: ['home', 'Café', 'a"b', 'x'.repeat(33), ''], wifi_password: [`${secret}-1`, 'short', '********', ''],
  wifi_country: ['DE', 'de', 'DEU', ''], page_password: [`${secret}-2`, '********', 'seven', ''], time_zone: ['Europe/Berlin', '../../etc/passwd', 'Mars'],
  ssh_key: [key, 'ssh-rsa AAAA', `command="touch ${pwned}" ${key}`, '-----BEGIN OPENSSH PRIVATE KEY-----'], rig: ['real', 'simulated', 'other'],
  'scan.frames': ['7', '-1', '1e999', '"7"', '[]'], 'turntable.pins': ['[17, 18]', '{}', 'x'], memory_limit_mb: ['64', '0'], threads: ['2', '1e9'],
  password_file: ['/etc/shadow'], 'nonsense': ['1'],
};

function someText() {
  let text = random.chance(0.2) ? '\ufeff' : '';
  for (let lines = random.below(12); lines > 0; --lines) {
    const name = random.pick(Object.keys(values));
    let value = random.pick(values[name]);
    if (random.chance(0.4)) {
      const at = random.below(value.length + 1);
      value = value.slice(0, at) + random.pick(traps) + value.slice(at);
    }
    text += random.pick(['', '', ' ', '#']) + name + random.pick(['=', ' = ', '\t=', ' ', ' == ']) + value + random.pick(['\n', '\r\n', ' \n', '']);
  }
  return random.chance(0.2) && text !== '' ? damagedBytes(random, Buffer.from(text)) : Buffer.from(text);
}

/** Each line of a file must match. */
function requireLines(file, pattern) {
  const path = join(root, file);
  const lines = existsSync(path) ? readFileSync(path, 'utf8').split('\n').slice(0, -1) : [];
  for (const line of lines) {
    require(pattern.test(line), `${file} has the line ${JSON.stringify(line)}`);
  }
}

const wifiLine = new RegExp(`^(ctrl_interface=/run/wpa_supplicant|p2p_disabled=1|pmf=1|country=[A-Z]{2}|network=\\{|\\}|  ssid=([0-9a-f]{2})+|  scan_ssid=1|
  |  key_mgmt=(NONE|SAE|WPA-PSK|WPA-PSK WPA-PSK-SHA256)|  priority=[12]|  ieee80211w=[02]|  psk=[0-9a-fA-F]{64}|  sae_password=([0-9a-f]{2})+)$`
    .replace(/\n */g, ''));

/** Starts the appliance with a file, as after a boot of a card that was never used. */
function apply(text) {
  rmSync(root, {recursive: true, force: true});
  for (const made of ['etc/octurn', 'data/octurn', 'run/octurn-settings', 'run/octurn-appliance/requests', 'usr/share/zoneinfo/Europe']) {
    mkdirSync(join(root, made), {recursive: true});
  }
  writeFileSync(join(root, 'etc/octurn/octurn.json'), readFileSync(join(repository, 'systemd/octurn.json')));
  writeFileSync(join(root, 'usr/share/zoneinfo/Europe/Berlin'), 'TZif2');
  writeFileSync(join(root, 'run/octurn-settings/octurn.txt'), text);
  const outside = readdirSync(folder).join();
  let said = '';
  for (const program of ['settings', 'page-password', 'wifi']) {
    const {status, stdout, stderr} = spawnSync(join(programs, program), [root],
        {encoding: 'utf8', env: {...process.env, PATH: `${dirname(process.env.OCTURN_PROGRAM)}:${process.env.PATH}`}});
    require(status === 0, `${program} ends with ${status}: ${stdout} ${stderr}`);
    said += stdout + stderr;
  }
  require(readdirSync(folder).join() === outside, 'a text was executed');
  require(!said.includes(secret), `a password is repeated: ${said}`);
  return said;
}

function check() {
  requireLines('etc/hostname', /^[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?$/);
  requireLines('root/.ssh/authorized_keys', /^(ssh-(ed25519|rsa)|ecdsa-sha2-nistp(256|384|521)|sk-[^ ]*@openssh\.com) [A-Za-z0-9+/=]+( .*)?$/);
  requireLines('etc/wpa_supplicant/wpa_supplicant-wlan0.conf', wifiLine);
  requireLines('data/page-password', /^octurn:Octurn:[0-9a-f]{32}$/);
  requireLines('data/wifi', /^([0-9a-f]{2})* ?[0-9a-fA-F]*( ([0-9a-f]{2})*)?$/);
  requireLines('run/octurn-settings/environment', /^OCTURN_OPTIONS=--simulate$/);
  const config = JSON.parse(readFileSync(join(root, 'etc/octurn/octurn.json'), 'utf8'));
  require([undefined, '/data/page-password', '/dev/null'].includes(config.password_file), `the password is in ${config.password_file}`);
  const {status, stderr} = spawnSync(process.env.OCTURN_PROGRAM, ['set', join(root, 'etc/octurn/octurn.json'), 'threads=1'], {encoding: 'utf8'});
  require(status === 0, `octurn.json is not read: ${stderr}`);
  for (const file of filesBelow(join(root, 'run/octurn-appliance'))) {
    require(!readFileSync(file, 'utf8').includes(secret), `a password is in ${file}`);
  }
}

let text = Buffer.alloc(0);
try {
  let complaints = 0;
  for (let i = 0; i < files; ++i) {
    text = someText();
    complaints += apply(text).split('\n').length - 1;
    check();
  }
  require(complaints > 0, 'nothing was wrong in any file');
  console.log(`counted: octurn_txt: ${files} files (seed ${seed}), ${complaints} complaints, nothing executed or repeated`);
} catch (error) {
  console.error(`octurn_txt: seed ${seed}: ${JSON.stringify(text.toString())}: ${error.message}`);
  process.exit(1);
}
