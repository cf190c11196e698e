// Requests of every route of web/openapi.json, valid and randomly mutated.

import {readFileSync} from 'node:fs';

import {smallScan, zipOf} from './archives.mjs';

const settings = {
  snapshots: [1, 2, 3, 0, -1, 3.5, 1e9, '3'], filter: ['basic', 'average', 'average-discard', 'none', 1], frames: [1, 2, 0, 1e9],
  method: ['solid', 'intersection', 'Solid', null], leaf_size_mm: [2, 4, 8, 0, -1, 1e300, 1e-300], max_error_mm: [0.04, 1, -1, 1e9],
  threshold_m2: [0.0001, 0, -1], root_size_mm: [500, 1000, 0, 1e308], calibrate: ['told', 'auto', 'else'],
  clip_mm: [[-140, -140, 5, 140, 140, 400], [0, 0, 0, 0, 0, 0], [1, 2, 3], [-1e300, -1e300, -1e300, 1e300, 1e300, 1e300], {}],
  platform_from_sensor: [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.6], [0, 0, 0, 1]], [[1]], [], null], level: [9, 0, 99],
};
const quick = {snapshots: [1, 2, 3, 12], frames: [1], leaf_size_mm: [4, 8]};
const odd = [null, true, -0, 1e999, '', '\u0000', '\ud800', 'ä€😀', [], {}, [[]], '../..', 'x'.repeat(300), 2 ** 53, -(2 ** 63)];

/** JSON that is mostly valid for a route, and sometimes far from it. */
function someJson(random, keys) {
  if (random.chance(0.03)) {
    const depth = random.pick([10, 100, 2000, 10_000]);
    return random.pick(['['.repeat(depth) + ']'.repeat(depth), '{"a":'.repeat(depth) + '1' + '}'.repeat(depth), '['.repeat(depth)]);
  }
  const body = {};
  const share = Object.keys(keys).length > 4 ? 0.3 : 0.7; // of the keys: one wrong value of many would refuse each request
  for (const [key, values] of Object.entries(keys)) {
    if (random.chance(share)) {
      body[key] = random.chance(0.85) ? random.pick(values) : random.pick(odd);
    }
  }
  if (random.chance(0.05)) {
    body[random.pick(['', 'a', '__proto__', 'snapshots\u0000'])] = random.pick(odd);
  }
  let text = JSON.stringify(random.chance(0.03) ? random.pick(odd) : body);
  if (random.chance(0.05)) {
    const at = random.below(text.length + 1);
    text = random.pick([text.slice(0, at), text + text, text.slice(0, at) + random.pick(['NaN', '1e99999', '\\u', '"', '\u0007', '}']) +
      text.slice(at)]);
  }
  return text;
}

const label = {name: ['a scan', '', 'x'.repeat(100), 'x'.repeat(101), 'a\nb', '"; filename=x'], notes: ['two\nlines', 5], tags: [['a', 'b'], ['a', 'a'], 'a'],
  author: ['Jane'], licence: ['CC0', null]};
const wifi = {name: ['Home', ''], password: ['open sesame', 'short'], country: ['DE', 'de', 'XX']};
const build = {method: settings.method, leaf_size_mm: settings.leaf_size_mm, calibrate: settings.calibrate, choose: [true, false, 1]};
const point = [1, 2, 3];
const registration = {candidate: [0, 1, -1], pairs_mm: [[[point, point], [[0, 9, 3], [0, 9, 3]], [[9, 0, 3], [9, 0, 3]]], [[point, point]], [[]]]};
const calibration = {platform_from_sensor: settings.platform_from_sensor, scale: [1, 0, -1], sensor_map: [null, 1], optics: [null, 1], lens: ['keep', 'discard']};
const configuration = {scan: [{frames: 2}, {snapshots: 3, leaf_size_mm: 4}, {leaf_size_mm: null}, {frames: 0}, {}], model_formats: [['3mf', 'ply', 'glb', 'obj'], ['doc']]};
const printer = {name: ['Voron', ''], kind: ['moonraker', 'octoprint', 'prusalink', 'x'], url: ['http://127.0.0.1:9', 'ftp://x'], key: ['k', 'a\r\nb']};
const queries = ['', '', '', '?leaf_size_mm=4', '?leaf_size_mm=8&level=9', '?level=x', '?leaf_size_mm=', '?&&=&a', `?${'a=1&'.repeat(50)}`,
  '?leaf_size_mm=%', '?leaf_size_mm=1e999', '?%00=%ff', '?colour=true', '?format=ply', '?ids=', '?paper=letter'];

// Relative frequency, method, path, values of the body's keys.
const routes = [
  [4, 'GET', '/'], [2, 'GET', '/style.css'], [8, 'GET', '/api/v1/status'], [4, 'GET', '/Scan.stl'], [0.5, 'GET', '/api/v1/messages'],
  [0.2, 'GET', '/api/v1/openapi.json'], [0.2, 'GET', '/api/v1/doctor'], [0.2, 'GET', '/api/v1/diagnostics.zip'],
  [6, 'GET', '/api/v1/scans'], [4, 'POST', '/api/v1/scans', settings], [4, 'POST', '/api/v1/scans', quick],
  [1, 'POST', '/api/v1/scans/estimate', settings],
  [1, 'POST', '/api/v1/scans/import', 'archive'], [0.5, 'GET', '/api/v1/scans.csv'], [0.5, 'GET', '/api/v1/scans.zip'],
  [6, 'GET', '/api/v1/scans/{id}'], [6, 'PATCH', '/api/v1/scans/{id}', label], [1, 'DELETE', '/api/v1/scans/{id}'],
  [1, 'POST', '/api/v1/scans/{id}/cancel', {}], [0.5, 'POST', '/api/v1/scans/{id}/end', {}], [1, 'POST', '/api/v1/scans/{id}/pause', {}],
  [3, 'POST', '/api/v1/scans/{id}/resume', {}], [2, 'POST', '/api/v1/scans/{id}/restore', {}],
  [6, 'GET', '/api/v1/scans/{id}/Scan.stl'], [2, 'GET', '/api/v1/scans/{id}/Scan.{format}'], [1, 'GET', '/api/v1/scans/{id}/coarse.stl'],
  [1, 'GET', '/api/v1/scans/{id}/thumbnail.png'], [4, 'GET', '/api/v1/scans/{id}/preview.stl'], [1, 'GET', '/api/v1/scans/{id}/scan.zip'],
  [2, 'GET', '/api/v1/scans/{id}/builds'], [3, 'POST', '/api/v1/scans/{id}/builds', build], [1, 'GET', '/api/v1/scans/{id}/builds/{number}'],
  [1, 'DELETE', '/api/v1/scans/{id}/builds/{number}'], [1, 'POST', '/api/v1/scans/{id}/builds/{number}/cancel', {}],
  [1, 'POST', '/api/v1/scans/{id}/builds/{number}/choose', {}], [1, 'GET', '/api/v1/scans/{id}/builds/{number}/Scan.stl'],
  [0.5, 'GET', '/api/v1/scans/{id}/builds/{number}/Scan.{format}'], [0.5, 'GET', '/api/v1/scans/{id}/builds/{number}/coarse.stl'],
  [1, 'GET', '/api/v1/scans/{id}/poses'], [1, 'POST', '/api/v1/scans/{id}/poses', settings], [1, 'POST', '/api/v1/scans/{id}/poses', quick],
  [1, 'POST', '/api/v1/scans/{id}/poses/{number}', registration], [1, 'DELETE', '/api/v1/scans/{id}/poses/{number}'],
  [1, 'GET', '/api/v1/scans/{id}/poses/{number}/points'], [1, 'GET', '/api/v1/scans/{id}/send'],
  [1, 'POST', '/api/v1/scans/{id}/send', {printer: ['Voron', 'nobody'], format: ['stl', '3mf', 'doc']}], [1, 'DELETE', '/api/v1/scans/{id}/send'],
  [2, 'GET', '/api/v1/bin'], [0.5, 'DELETE', '/api/v1/bin'],
  [1, 'GET', '/api/v1/preview/depth.png'], [2, 'GET', '/api/v1/preview/points'], [2, 'GET', '/api/v1/turntable'],
  [1, 'POST', '/api/v1/turntable', {jog_deg: [10, 1e9], test: [true], stop: [true]}],
  [2, 'GET', '/api/v1/calibration'], [1, 'POST', '/api/v1/calibration', {kind: ['turn', 'wall', 'lens'], stops: [8, 24, -1]}],
  [2, 'POST', '/api/v1/calibration/cancel', {}], [0.5, 'POST', '/api/v1/calibration/solve', {}], [1, 'POST', '/api/v1/calibration/undo', {}],
  [1, 'PATCH', '/api/v1/calibration', calibration], [1, 'GET', '/api/v1/calibration/sensor-map'], [0.5, 'GET', '/api/v1/calibration/board.pdf'],
  [4, 'GET', '/api/v1/settings'], [2, 'PATCH', '/api/v1/settings', configuration], [2, 'GET', '/api/v1/settings/backup'],
  [1, 'POST', '/api/v1/settings/backup', {format: ['octurn-settings'], version: [1, 2], program: ['0.2.0'], settings: [{scan: {frames: 3}}, {scan: 1}]}],
  [1, 'GET', '/api/v1/keys'], [1, 'POST', '/api/v1/keys', {name: ['a program', ''], access: ['read', 'full', 'all']}], [1, 'DELETE', '/api/v1/keys/{key}'],
  [1, 'GET', '/api/v1/webhooks'], [1, 'POST', '/api/v1/webhooks', {url: ['http://127.0.0.1:9/hook', 'ftp://x'], events: [['scan-finished'], ['x'], []]}],
  [1, 'DELETE', '/api/v1/webhooks/{webhook}'], [1, 'POST', '/api/v1/webhooks/{webhook}/test', {}],
  [1, 'GET', '/api/v1/printers'], [1, 'POST', '/api/v1/printers', printer], [1, 'DELETE', '/api/v1/printers/{printer}'],
  [1, 'PATCH', '/api/v1/printers/{printer}', {fingerprint: [`sha256//${'A'.repeat(43)}=`, '', 'x', 7]}],
  [1, 'GET', '/api/v1/machine'], [1, 'PATCH', '/api/v1/machine', {name: ['one', '-n'], time_zone: ['Europe/Berlin', '../x']}],
  [1, 'PUT', '/api/v1/machine/clock', {unix_s: [1795824000, 0, 'now']}], [0.5, 'POST', '/api/v1/machine/restart', {}],
  [0.5, 'POST', '/api/v1/machine/shutdown', {}], [2, 'GET', '/api/v1/wifi'], [3, 'PUT', '/api/v1/wifi', wifi],
  [2, 'GET', '/api/v1/update'], [2, 'PUT', '/api/v1/update', 'bytes'],
];
// A stream of events has no end, and a password that is taken would shut the attack out.
const others = ['GET /api/v1/events', 'PUT /api/v1/settings/password'];

/** Routes of the interface that no request asks for. @returns {string[]} */
export function missingRoutes() {
  const {paths} = JSON.parse(readFileSync(new URL('../../web/openapi.json', import.meta.url), 'utf8'));
  const nameless = (path) => path.replace(/\{(?!format)\w+\}/g, '{}');
  const asked = new Set([...others, ...routes.map(([, method, path]) => `${method} ${nameless(path)}`)]);
  const all = Object.entries(paths).flatMap(([path, methods]) => ['get', 'post', 'put', 'patch', 'delete']
      .filter((method) => method in methods).map((method) => `${method.toUpperCase()} ${nameless(path)}`));
  return all.filter((route) => !asked.has(route));
}

const totalWeight = routes.reduce((sum, [weight]) => sum + weight, 0);

function someRoute(random) {
  let at = random.below(totalWeight * 1000) / 1000;
  return routes.find(([weight]) => (at -= weight) < 0) ?? routes[0];
}

function someId(random, ids = []) {
  if (ids.length > 0 && random.chance(0.8)) {
    return random.pick(ids);
  }
  return random.pick(['20261121-081500-3f2a', 'x', '', '.', '..', '%2e%2e', '..%2f..', '%00', '%c0%ae', 'a'.repeat(3000), '20261121-081500-3f2a/..']);
}

/** A path with ids, numbers and names in their places. */
function filled(random, path, known) {
  return path.replace(/\{(\w+)\}/g, (_, what) => {
    switch (what) {
      case 'number':
        return random.chance(0.9) ? String(random.below(4)) : random.pick(['-1', 'x', '99999999999', '']);
      case 'format':
        return random.pick(['3mf', 'ply', 'glb', 'obj', 'stl', 'doc', '..']);
      case 'id':
        return someId(random, known.ids);
      default:
        return someId(random, known[what]);
    }
  });
}

/** The body of a route's requests. @returns {Buffer} */
function someBody(random, content) {
  if (content === undefined) {
    return Buffer.alloc(0);
  }
  if (content === 'archive') {
    return random.chance(0.7) ? zipOf(smallScan()) : random.bytes(random.below(5000));
  }
  return content === 'bytes' ? random.bytes(random.below(5000)) : Buffer.from(someJson(random, content));
}

const hosts = ['localhost', '127.0.0.1', 'octurn.local', '[::1]:80', 'evil.example', '', 'x'.repeat(500), '127.0.0.1, evil.example'];
const types = ['application/json; charset=utf-8', 'text/plain', 'application/octet-stream', '', 'multipart/form-data; boundary=x'];
const ranges = ['bytes=0-10', 'bytes=-1', 'bytes=5-', 'bytes=10-5', 'bytes=0-0,2-3', 'bytes=99999999999999999999-', 'lines=1', 'bytes=--', '='];
const otherHeaders = [
  'Expect: 100-continue', 'Connection: keep-alive, Upgrade\r\nUpgrade: websocket', 'Origin: http://evil.example', 'Origin: null',
  'Authorization: Digest username="octurn", nonce="', 'Authorization: Basic eA==', 'If-None-Match: *', 'If-Match: "x", W/"y',
  'If-Range: "x"', 'If-None-Match: ' + '"x",'.repeat(500), 'Accept-Encoding: gzip', 'Cookie: a=b', 'X: ' + 'y'.repeat(9000),
  ' folded: yes', 'no colon', ': no name', 'X\u0000Y: z', 'Content-Length: 0', 'Transfer-Encoding: identity', 'TE: trailers',
];

/** The body in chunked transfer coding, mostly valid. */
function inChunks(random, body) {
  const parts = [];
  for (let at = 0; at < body.length;) {
    const size = 1 + random.below(Math.min(body.length - at, 1000));
    const told = random.chance(0.95) ? size.toString(16) : random.pick(['zz', '-1', 'ffffffffffffffff', '', '1 ', (size + 5).toString(16)]);
    parts.push(Buffer.from(`${told}\r\n`), body.subarray(at, at + size), Buffer.from(random.chance(0.97) ? '\r\n' : '\n'));
    at += size;
  }
  parts.push(Buffer.from(random.chance(0.9) ? '0\r\n\r\n' : random.pick(['', '0\r\n', '0\r\nX: y\r\n\r\n'])));
  return Buffer.concat(parts);
}

/** Deletes, duplicates or replaces some bytes. */
function damage(random, bytes) {
  const at = random.below(bytes.length);
  const to = Math.min(bytes.length, at + 1 + random.below(20));
  return random.pick([
    () => Buffer.concat([bytes.subarray(0, at), bytes.subarray(to)]),
    () => Buffer.concat([bytes.subarray(0, to), bytes.subarray(at)]),
    () => Buffer.concat([bytes.subarray(0, at), random.bytes(to - at), bytes.subarray(to)]),
    () => Buffer.concat([bytes.subarray(0, at), Buffer.from(random.pick(['\r\n\r\n', '\u0000', '%00', '\n', '//', '..'])), bytes.subarray(at)]),
  ])();
}

function framing(random, method, body) {
  if (method === 'GET' && body.length === 0) {
    return {header: '', sent: body};
  }
  if (random.chance(0.15)) {
    return {header: 'Transfer-Encoding: chunked\r\n', sent: inChunks(random, body)};
  }
  const length = random.chance(0.9) ? body.length :
    random.pick([0, body.length + 1, body.length - 1, 70_000, 1e12, -1, 'x', '1 1', '0x10', '+5', '99999999999999999999999']);
  return {header: random.chance(0.97) ? `Content-Length: ${length}\r\n` : '', sent: body};
}

function headersOf(random, port, isUpload) {
  let text = `Host: ${random.chance(0.93) ? `127.0.0.1:${port}` : random.pick(hosts)}\r\n`;
  const type = isUpload ? 'application/octet-stream' : 'application/json';
  text += `Content-Type: ${random.chance(0.95) ? type : random.pick(types)}\r\n`;
  if (random.chance(0.1)) {
    text += `Range: ${random.pick(ranges)}\r\n`;
  }
  while (random.chance(0.12)) {
    text += `${random.pick(otherHeaders)}\r\n`;
  }
  return random.chance(0.003) ? text + 'A: b\r\n'.repeat(100) : text;
}

/**
 * @param {import('./random.mjs').Random} random
 * @param {{ids: string[], key: string[], webhook: string[], printer: string[], port: number}} known  the ids of the server's scans, keys and
 *     addresses, and its port
 * @returns {{route: string, bytes: Buffer, parts: number, ending: 'end'|'reset'}}  the bytes, the number of writes, and how the connection ends
 */
export function someRequest(random, known) {
  const [, usual, path, content] = someRoute(random);
  const method = random.chance(0.94) ? usual :
    random.pick(['HEAD', 'PUT', 'OPTIONS', 'TRACE', 'CONNECT', 'get', 'PROPFIND', 'G T', '', 'X'.repeat(200), 'POST', 'DELETE']);
  let target = filled(random, path, known) + (random.chance(0.2) ? random.pick(queries) : '');
  if (random.chance(0.03)) {
    target = random.pick(['*', `http://127.0.0.1:${known.port}${target}`, `//${target}`, target.replaceAll('/', '//'), `${target}/`, `${target}#x`,
      `/..${target}`, target + '/x'.repeat(2000), encodeURIComponent(target), target.toUpperCase(), `${target}%`, 'ftp://x', '']);
  }
  const {header, sent} = framing(random, method, someBody(random, content));
  const version = random.chance(0.98) ? 'HTTP/1.1' : random.pick(['HTTP/1.0', 'HTTP/2.0', 'HTTP/9.9', 'http/1.1', '']);
  const head = `${method} ${target} ${version}\r\n${headersOf(random, known.port, typeof content === 'string')}${header}\r\n`;
  let bytes = Buffer.concat([Buffer.from(head, 'latin1'), sent]);
  while (random.chance(0.08) && bytes.length > 0) {
    bytes = damage(random, bytes);
  }
  const cut = random.chance(0.04);
  if (cut) {
    bytes = bytes.subarray(0, random.below(bytes.length + 1));
  }
  return {route: `${usual} ${path}`, bytes, parts: random.chance(0.1) ? 1 + random.below(4) : 1, ending: random.chance(cut ? 0.5 : 0.02) ? 'reset' : 'end'};
}
