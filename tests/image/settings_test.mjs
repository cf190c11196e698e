// The settings in octurn.txt other than WiFi: time zone, SSH key, page password.

import {createHash, generateKeyPairSync} from 'node:crypto';

import {require} from './checks.mjs';

const field = (bytes) => Buffer.concat([Buffer.from([0, 0, bytes.length >> 8, bytes.length & 255]), bytes]);

/** A new SSH key pair. @returns {{line: string, secret: string}} the public key for octurn.txt, and the private key in dropbear's format,
 * base64 */
export function makeSshKey() {
  const {d, x} = generateKeyPairSync('ed25519').privateKey.export({format: 'jwk'});
  const [secret, open] = [d, x].map((text) => Buffer.from(text, 'base64url'));
  const type = field(Buffer.from('ssh-ed25519'));
  return {
    line: `ssh-ed25519 ${Buffer.concat([type, field(open)]).toString('base64')} boot-test`,
    secret: Buffer.concat([type, field(Buffer.concat([secret, open]))]).toString('base64'),
  };
}

const md5 = (text) => createHash('md5').update(text).digest('hex');

/** Requests the page by HTTP Digest (RFC 7616) with this password. @returns the status */
async function open(url, password) {
  const wish = (await fetch(url)).headers.get('www-authenticate');
  const nonce = /nonce="([^"]*)"/.exec(wish)[1];
  const answer = md5([md5(`octurn:Octurn:${password}`), nonce, '00000001', 'boot-test', 'auth', md5('GET:/')].join(':'));
  const response = await fetch(url, {headers: {Authorization: `Digest username="octurn", realm="Octurn", nonce="${nonce}", uri="/", ` +
    `qop=auth, nc=00000001, cnonce="boot-test", response="${answer}"`}});
  return response.status;
}

async function testSsh(guest, key) {
  await guest.run(`echo ${key.secret} | base64 -d >/run/key; until (: </dev/tcp/127.0.0.1/22) 2>/dev/null; do sleep 1; done`);
  const login = (options) => guest.run(`dbclient -y ${options} root@127.0.0.1 'id -un' </dev/null 2>&1 | tail -n 1`);
  const root = await login('-i /run/key');
  require(root === 'root', `with the key in octurn.txt, SSH says ${root}`);
  const nobody = await login('');
  require(nobody.includes('No auth methods could be used'), `without a key, SSH says ${nobody}`);
  const file = await guest.run('stat -c "%a %n" /data/ssh /data/ssh/*');
  require(file === '700 /data/ssh\n600 /data/ssh/host_key\n600 /data/ssh/host_key.pub', `the host's key is ${file}`);
}

async function testPassword(guest) {
  require((await fetch(guest.url)).status === 200, 'the page asks for a password that nobody has set');
  // Restarts the services that a boot would start.
  const start = 'systemctl restart octurn-page-password; systemctl restart octurn';
  await guest.run('cp /etc/octurn/octurn.json /run/; echo "page_password = open sesame" >>/run/octurn-settings/octurn.txt; ' +
    `: >/run/octurn-settings/page-password; ${start}`);
  require((await fetch(guest.url)).status === 401, 'the page asks for no password');
  for (const [password, status] of [['open sesame', 200], ['sesame', 401]]) {
    const answered = await open(guest.url, password);
    require(answered === status, `with the password ${password} the page answers ${answered}`);
  }
  const hidden = await guest.run('grep page_password /run/octurn-settings/octurn.txt');
  require(hidden === 'page_password = ********', `octurn.txt has ${hidden}`);
  await guest.run('sed -i /page_password/d /run/octurn-settings/octurn.txt; rm /run/octurn-settings/page-password; ' +
    `cp /run/octurn.json /etc/octurn/; ${start}`);
  require((await fetch(guest.url)).status === 200, 'the page asks for a password that was taken away');
}

/** @param {{secret: string}} key  whose public half is in octurn.txt, which also sets Berlin's time zone */
export async function testSettings(guest, key, say) {
  const zone = await guest.run('date -d @1750000000 +%H:%M');
  require(zone === '17:06', `in Berlin it was 17:06, and not ${zone}`);
  await testSsh(guest, key);
  await testPassword(guest);
  say('the time zone; SSH with the key alone; the page with its password alone');
}
