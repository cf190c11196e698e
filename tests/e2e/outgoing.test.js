// Outgoing requests of the scanner: webhooks, and models for printers. Each printer here is a server that answers as its
// interface is documented and records the requests.

import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {X509Certificate, createHash} from 'node:crypto';
import {once} from 'node:events';
import {mkdtemp, readdir, readFile, readlink, rm} from 'node:fs/promises';
import {createServer} from 'node:http';
import {createServer as createSecureServer} from 'node:https';
import {createServer as createSilentServer} from 'node:net';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';
import {promisify} from 'node:util';

import {openBrowser, openPage, picture} from './browser.js';
import {ask, quick, scan, scanFolders, startScanner} from './scanner.js';

/**
 * A server on loopback for a test.
 * @param {(request: any, body: Buffer) => {status: number, headers?: Object, body?: any}} answer
 * @param {{key?: string, cert?: string}} [secret]  of TLS
 * @param {number} [port]  0: any
 */
async function serve(t, answer, secret = {}, port = 0) {
  const received = [];
  const server = (secret.key ? createSecureServer : createServer)(secret, async (request, response) => {
    const parts = [];
    for await (const part of request) {
      parts.push(part);
    }
    const body = Buffer.concat(parts);
    const given = answer(request, body);
    received.push({method: request.method, url: request.url, headers: request.headers, body, status: given.status});
    response.writeHead(given.status, {'Content-Type': 'application/json', ...given.headers});
    response.end(given.body === undefined ? '' : JSON.stringify(given.body));
  });
  server.listen(port, '127.0.0.1');
  await once(server, 'listening');
  const close = async () => {
    server.closeAllConnections();
    await promisify(server.close).call(server).catch(() => {});  // closed already
  };
  t.after(close);
  return {url: `${secret.key ? 'https' : 'http'}://127.0.0.1:${server.address().port}`, port: server.address().port, received, close};
}

/** A key, a certificate that it signed itself, and the fingerprint of the key as curl writes it. */
async function makeSecret(t) {
  const folder = await mkdtemp(join(tmpdir(), 'octurn-'));
  t.after(() => rm(folder, {recursive: true}));
  const [keyFile, certFile] = ['key', 'cert'].map((name) => join(folder, name));
  await promisify(execFile)('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes',
    '-subj', '/CN=printer', '-days', '2', '-keyout', keyFile, '-out', certFile]);
  const cert = await readFile(certFile, 'utf8');
  const publicKey = new X509Certificate(cert).publicKey.export({type: 'spki', format: 'der'});
  return {key: await readFile(keyFile, 'utf8'), cert, fingerprint: `sha256//${createHash('sha256').update(publicKey).digest('base64')}`};
}

/** The fields and the file of a multipart form. @param {{headers: any, body: Buffer}} request */
async function formOf({headers, body}) {
  const form = await new Response(body, {headers: {'Content-Type': headers['content-type']}}).formData();
  const file = form.get('file');
  return {form, name: file.name, bytes: Buffer.from(await file.arrayBuffer())};
}

/** Polls until `look` returns something truthy. @template T @param {() => T | Promise<T>} look @returns {Promise<T>} */
async function until(look) {
  for (;;) {
    const found = await look();
    if (found) {
      return found;
    }
    await new Promise((done) => {
      setTimeout(done, 20);
    });
  }
}

/** Sends a scan to a printer, and waits for the end. */
async function send(scanner, id, body) {
  await ask(scanner, `scans/${id}/send`, 'POST', body);
  return until(async () => {
    const upload = await ask(scanner, `scans/${id}/send`);
    return upload.state !== 'sending' && upload;
  });
}

const key = 'a-key-of-the-printer';

/** OctoPrint (docs.octoprint.org, "File operations"): the key in X-Api-Key, a form with `file`; 415 for unusable files. */
const octoprint = (takes) => (request, body) => {
  if (request.headers['x-api-key'] !== key) {
    return {status: 403};
  }
  if (request.method !== 'POST' || request.url !== '/octoprint/api/files/local') {
    return {status: 404};
  }
  const name = /filename="([^"]*)"/.exec(body.toString('latin1'))[1];
  return takes.test(name) ? {status: 201, body: {files: {local: {name, origin: 'local'}}, done: true}} : {status: 415};
};

/** Moonraker (moonraker.readthedocs.io, "File upload"): a form with `file` and `root`; 201. */
const moonraker = (request) => request.method === 'POST' && request.url === '/server/files/upload' ?
  {status: 201, body: {item: {path: 'x', root: 'gcodes'}, print_started: false, action: 'create_file'}} : {status: 404};

/** PrusaLink (its openapi.yaml): Digest; GET /api/v1/storage; PUT /api/v1/files/STORAGE/NAME. */
const prusalink = (takes) => (request) => {
  const given = request.headers.authorization ?? '';
  const field = (name) => new RegExp(`${name}="?([^",]*)`).exec(given)?.[1];
  const md5 = (text) => createHash('md5').update(text).digest('hex');
  const proof = md5([md5(`maker:Printer API:${key}`), 'n1', field('nc'), field('cnonce'), 'auth', md5(`${request.method}:${request.url}`)].join(':'));
  if (field('response') !== proof) {
    return {status: 401, headers: {'WWW-Authenticate': 'Digest realm="Printer API", nonce="n1", qop="auth"'}};
  }
  if (request.method === 'GET' && request.url === '/api/v1/storage') {
    return {status: 200, body: {storage_list: [
      {name: 'SD', type: 'SDCARD', path: '/sdcard', available: true, read_only: true},
      {name: 'USB', type: 'USB', path: '/usb', available: true, read_only: false}]}};
  }
  if (request.method !== 'PUT' || !request.url.startsWith('/api/v1/files/usb/')) {
    return {status: 404};
  }
  return {status: takes.test(request.url) ? 201 : 415};
};

test('a model goes to each kind of printer, whole, and nothing is printed', async (t) => {
  const scanner = await startScanner(t, quick);
  const {id} = await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  await ask(scanner, `scans/${id}`, 'PATCH', {name: 'Ölkanne 1'});
  const [folder] = await scanFolders(scanner);
  const model = await readFile(join(folder, 'Scan.stl'));

  const octo = await serve(t, octoprint(/\.stl$/));
  await ask(scanner, 'printers', 'POST', {name: 'Ender', kind: 'octoprint', url: `${octo.url}/octoprint/`, key});
  const upload = await send(scanner, id, {printer: 'Ender'});
  assert.deepEqual([upload.state, upload.progress, upload.file], ['sent', 1, 'Ölkanne 1.stl'], upload.detail);
  const sent = await formOf(octo.received.at(-1));
  assert.equal(sent.name, 'Ölkanne 1.stl');
  assert.equal(sent.form.get('print'), 'false');
  assert.ok(sent.bytes.equals(model));

  const plainNames = await serve(t, (request, body) => ({status: body.includes('filename="Scan-') ? 201 : 400}));
  await ask(scanner, 'printers', 'POST', {name: 'Old', kind: 'octoprint', url: plainNames.url, key});
  const renamed = await send(scanner, id, {printer: 'Old'});
  assert.deepEqual([renamed.state, renamed.file], ['sent', `Scan-${id}.stl`], renamed.detail);

  const moon = await serve(t, moonraker);
  const voron = await ask(scanner, 'printers', 'POST', {name: 'Voron', kind: 'moonraker', url: moon.url});
  assert.equal((await send(scanner, id, {printer: voron.id, format: '3mf'})).state, 'sent');
  const threemf = await formOf(moon.received.at(-1));
  assert.equal(threemf.form.get('root'), 'gcodes');
  assert.ok(threemf.bytes.equals(await readFile(join(folder, 'Scan.3mf'))));

  const prusa = await serve(t, prusalink(/\.stl$/));
  await ask(scanner, 'printers', 'POST', {name: 'MK4', kind: 'prusalink', url: prusa.url, user: 'maker', key});
  const last = await send(scanner, id, {printer: 'MK4'});
  assert.equal(last.state, 'sent', last.detail);
  const put = prusa.received.at(-1);
  assert.equal(put.url, `/api/v1/files/usb/${encodeURIComponent('Ölkanne 1.stl')}`);
  assert.equal(put.headers['print-after-upload'], '?0');
  assert.ok(put.body.equals(model));

  assert.ok(!JSON.stringify(await ask(scanner, 'printers')).includes(key));
  const diagnostics = Buffer.from(await (await fetch(`${scanner.url}api/v1/diagnostics.zip`)).arrayBuffer());
  assert.ok(!diagnostics.includes(key)); // the zip's files are not compressed
});

test('a printer whose certificate no authority signed gets nothing until it is trusted, and no other one in its place', async (t) => {
  const scanner = await startScanner(t, quick);
  const {id} = await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  const [own, other] = [await makeSecret(t), await makeSecret(t)];
  for (const [kind, takes] of /** @type {[string, any][]} */ ([['octoprint', octoprint(/\.stl$/)], ['prusalink', prusalink(/\.stl$/)]])) {
    const first = await serve(t, takes, own);
    const url = kind === 'octoprint' ? `${first.url}/octoprint` : first.url;
    const user = kind === 'octoprint' ? '' : 'maker';
    const printer = await ask(scanner, 'printers', 'POST', {name: kind, kind, url, user, key});
    const fingerprint = async () => (await ask(scanner, 'printers')).printers.find((one) => one.id === printer.id).fingerprint;
    for (const time of [1, 2]) {
      const asking = await send(scanner, id, {printer: kind});
      assert.deepEqual([asking.state, asking.fingerprint], ['failed', own.fingerprint], `${time}: ${asking.detail}`);
      assert.match(asking.hint, /^Trust it if/);
    }
    assert.deepEqual(first.received, [], 'nothing is sent, and nothing is trusted, before somebody says so');
    assert.equal(await fingerprint(), '');

    await ask(scanner, `printers/${printer.id}`, 'PATCH', {fingerprint: own.fingerprint});
    const upload = await send(scanner, id, {printer: kind});
    assert.deepEqual([upload.state, upload.fingerprint], ['sent', ''], upload.detail);
    await ask(scanner, 'settings/backup', 'POST', await ask(scanner, 'settings/backup'));
    await scanner.end();
    await scanner.restart();
    assert.equal(await fingerprint(), own.fingerprint);
    assert.equal((await send(scanner, id, {printer: kind})).state, 'sent');

    await first.close();
    const second = await serve(t, takes, other, first.port);
    const refused = await send(scanner, id, {printer: kind});
    assert.deepEqual([refused.state, refused.fingerprint], ['failed', '']);
    assert.ok(refused.detail.includes(other.fingerprint), refused.detail);
    assert.match(refused.hint, /remove it in the settings and add it again/);
    assert.deepEqual(second.received, [], 'neither key nor model is sent to it');
    assert.equal(await fingerprint(), own.fingerprint);

    await ask(scanner, `printers/${printer.id}`, 'PATCH', {fingerprint: ''});
    assert.equal((await send(scanner, id, {printer: kind})).fingerprint, other.fingerprint);
    assert.deepEqual(second.received, []);
  }
  await assert.rejects(ask(scanner, 'printers/none', 'PATCH', {fingerprint: own.fingerprint}), /not-found/);
});

test('the page asks before it trusts a certificate, and says which one it is', async (t) => {
  const scanner = await startScanner(t, quick);
  const {id} = await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  const own = await makeSecret(t);
  const {url, received} = await serve(t, octoprint(/\.stl$/), own);
  await ask(scanner, 'printers', 'POST', {name: 'Safe', kind: 'octoprint', url: `${url}/octoprint`, key});
  const browser = await openBrowser(t);
  const {page, faults} = await openPage(browser, `${scanner.url}#${id}`, {locale: 'de-DE', screen: 'phone'});
  await page.getByRole('button', {name: 'An den Drucker senden'}).click();
  await page.locator('#send-said', {hasText: `sein Fingerabdruck ist "${own.fingerprint}"`}).waitFor();
  await picture(page, 'printer-certificate');
  assert.deepEqual(received, []);
  await page.getByRole('button', {name: 'Vertrauen und senden'}).click();
  await page.locator('#send-said[data-tone=good]').waitFor();
  assert.ok(await page.locator('#send-trust').isHidden());
  assert.equal(received.length, 1);
  await page.goto(`${scanner.url}#settings`);
  await page.getByText(`Vertrautes Zertifikat: ${own.fingerprint}`).waitFor();
  assert.deepEqual(faults, []);
});

test('a printer that does not take a model says why, and what to do', async (t) => {
  const scanner = await startScanner(t, quick);
  const {id} = await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  const plain = await serve(t, octoprint(/\.gcode$/));
  const {url} = plain;
  const prusa = await serve(t, prusalink(/\.b?gcode$/));
  const redirect = await serve(t, () => ({status: 302, headers: {Location: `${url}/elsewhere`}}));
  const printers = [
    ['no slicer', {kind: 'octoprint', url: `${url}/octoprint`, key}, /415/, /plug-in/],
    ['wrong key', {kind: 'octoprint', url: `${url}/octoprint`, key: 'another'}, /403/, /key/],
    ['wrong kind', {kind: 'moonraker', url: `${url}/octoprint`, key}, /404/, /kind/],
    ['wrong password', {kind: 'prusalink', url: prusa.url, user: 'maker', key: 'another'}, /401/, /key/],
    ['only G-code', {kind: 'prusalink', url: prusa.url, user: 'maker', key}, /415/, /slice/],
    ['moved', {kind: 'moonraker', url: redirect.url}, /302/, /address/],
    ['off', {kind: 'moonraker', url: 'http://127.0.0.1:9'}, /reached/, /is on/],
  ];
  for (const [name, printer, detail, hint] of printers) {
    await ask(scanner, 'printers', 'POST', {name, ...printer});
    const upload = await send(scanner, id, {printer: name});
    assert.equal(upload.state, 'failed', name);
    assert.match(upload.detail, detail);
    assert.match(upload.hint, hint);
    assert.ok(!JSON.stringify(upload).includes(key));
  }
  assert.ok(plain.received.every(({url: asked}) => asked !== '/elsewhere'));
  await assert.rejects(ask(scanner, `scans/${id}/send`, 'POST', {printer: 'nobody'}), /bad-settings/);
});

test('a webhook is told what happens, and again if it did not listen', async (t) => {
  const scanner = await startScanner(t, quick);
  let isListening = true;
  const hub = await serve(t, () => ({status: isListening ? 204 : 500}));
  const told = () => hub.received.filter(({status}) => status === 204).map(({body}) => JSON.parse(body));
  const hook = await ask(scanner, 'webhooks', 'POST', {url: `${hub.url}/hook/secret`, events: ['scan-finished', 'scan-started']});
  assert.ok(!JSON.stringify(await ask(scanner, 'webhooks')).includes('secret'));

  const {id} = await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  const end = await until(() => told().find(({event}) => event === 'scan-finished'));
  assert.equal(end.scan.id, id);
  assert.equal(end.scan.state, 'finished');
  assert.ok(Math.abs(Date.parse(end.time) - Date.now()) < 3600e3);

  isListening = false;
  const heard = hub.received.length;
  await ask(scanner, `webhooks/${hook.id}/test`, 'POST', {});
  await until(() => hub.received.length > heard);
  assert.match((await until(async () => {
    const {webhooks: [{last}]} = await ask(scanner, 'webhooks');
    return last.event === 'test' && last.trouble !== '' && last;
  })).trouble, /500/);
  isListening = true;
  await until(() => told().some(({event}) => event === 'test'));

  await ask(scanner, `webhooks/${hook.id}`, 'DELETE');
  assert.deepEqual((await ask(scanner, 'webhooks')).webhooks, []);
});

/** The other ends of a program's sockets, but for those of its server. @returns {Promise<string[]>} as the kernel has them, "0100007F:1F90" */
async function otherEnds(pid, port) {
  const files = await readdir(`/proc/${pid}/fd`);
  const open = new Set(await Promise.all(files.map((file) => readlink(`/proc/${pid}/fd/${file}`).catch(() => ''))));
  const ends = [];
  for (const table of ['tcp', 'tcp6', 'udp', 'udp6']) {
    const [, ...lines] = (await readFile(`/proc/${pid}/net/${table}`, 'utf8')).trim().split('\n');
    for (const line of lines) {
      const [, local, remote, , , , , , , inode] = line.trim().split(/\s+/);
      if (open.has(`socket:[${inode}]`) && parseInt(local.split(':')[1], 16) !== port) {
        ends.push(remote);
      }
    }
  }
  return ends;
}

test('the scanner opens no connection unless somebody has given it an address', async (t) => {
  const scanner = await startScanner(t, quick);
  const look = () => otherEnds(scanner.process(), Number(new URL(scanner.url).port));
  let isDone = false;
  let looks = 0;
  const scanned = scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4}).finally(() => {
    isDone = true;
  });
  for (; !isDone; ++looks) {
    assert.deepEqual(await look(), []);
    await new Promise(setImmediate);
  }
  assert.equal((await scanned).state, 'finished');
  assert.ok(looks > 10);

  const silent = createSilentServer().listen(0, '127.0.0.1');
  await once(silent, 'listening');
  t.after(() => silent.close());
  const {port} = silent.address();
  await ask(scanner, 'webhooks', 'POST', {url: `http://127.0.0.1:${port}`, events: []});
  await scan(scanner, {snapshots: 4, frames: 2, leaf_size_mm: 4});
  const end = await until(async () => (await look())[0]);
  assert.equal(parseInt(end.split(':')[1], 16), port);
});
