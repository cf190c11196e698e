// Requests of every route of web/API.md, valid and randomly mutated.

const settings = {
  snapshots: [1, 2, 3, 0, -1, 3.5, 1e9, '3'], filter: ['basic', 'average', 'average-discard', 'none', 1], frames: [1, 2, 0, 1e9],
  method: ['solid', 'intersection', 'Solid', null], leaf_size_mm: [2, 4, 8, 0, -1, 1e300, 1e-300], max_error_mm: [0.04, 1, -1, 1e9],
  threshold_m2: [0.0001, 0, -1], root_size_mm: [500, 1000, 0, 1e308], calibrate: ['told', 'auto', 'else'],
  clip_mm: [[-140, -140, 5, 140, 140, 400], [0, 0, 0, 0, 0, 0], [1, 2, 3], [-1e300, -1e300, -1e300, 1e300, 1e300, 1e300], {}],
  platform_from_sensor: [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.6], [0, 0, 0, 1]], [[1]], [], null], level: [9, 0, 99],
};
const odd = [null, true, -0, 1e999, '', '\u0000', '\ud800', 'ä€😀', [], {}, [[]], '../..', 'x'.repeat(300), 2 ** 53, -(2 ** 63)];

/** JSON that is mostly valid for a route, and sometimes far from it. */
function someJson(random, keys) {
  if (random.chance(0.03)) {
    const depth = random.pick([10, 100, 2000, 10_000]);
    return random.pick(['['.repeat(depth) + ']'.repeat(depth), '{"a":'.repeat(depth) + '1' + '}'.repeat(depth), '['.repeat(depth)]);
  }
  const body = {};
  for (const [key, values] of Object.entries(keys)) {
    if (random.chance(0.3)) {
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

const names = {name: ['a scan', '', 'x'.repeat(100), 'x'.repeat(101), 'a\nb', '"; filename=x']};
const wifi = {name: ['Home', ''], password: ['open sesame', 'short'], country: ['DE', 'de', 'XX']};
const queries = ['', '', '', '?leaf_size_mm=4', '?leaf_size_mm=8&level=9', '?level=x', '?leaf_size_mm=', '?&&=&a', `?${'a=1&'.repeat(50)}`,
  '?leaf_size_mm=%', '?leaf_size_mm=1e999', '?%00=%ff'];

// Relative frequency, method, path, values of the body's keys.
const routes = [
  [4, 'GET', '/'], [2, 'GET', '/style.css'], [8, 'GET', '/api/v1/status'], [4, 'GET', '/api/v1/settings'], [4, 'GET', '/Scan.stl'],
  [0.2, 'GET', '/api/v1/doctor'], [0.2, 'GET', '/api/v1/diagnostics.zip'], [1, 'GET', '/api/v1/preview/depth.png'],
  [6, 'GET', '/api/v1/scans'], [8, 'POST', '/api/v1/scans', settings], [6, 'GET', '/api/v1/scans/{id}'],
  [6, 'PATCH', '/api/v1/scans/{id}', names], [3, 'DELETE', '/api/v1/scans/{id}'], [6, 'POST', '/api/v1/scans/{id}/cancel', {}],
  [3, 'POST', '/api/v1/scans/{id}/resume', {}], [6, 'GET', '/api/v1/scans/{id}/Scan.stl'], [4, 'GET', '/api/v1/scans/{id}/preview.stl'],
  [2, 'GET', '/api/v1/update'], [2, 'PUT', '/api/v1/update', 'bytes'], [2, 'GET', '/api/v1/wifi'], [3, 'PUT', '/api/v1/wifi', wifi],
  [2, 'PATCH', '/api/v1/settings', settings], [2, 'GET', '/api/v1/settings/backup'], [2, 'GET', '/api/v1/calibration'],
  [1, 'POST', '/api/v1/calibration', {kind: ['turn', 'wall'], stops: [8, 24, -1]}],
  [2, 'POST', '/api/v1/calibration/cancel', {}], [1, 'POST', '/api/v1/calibration/undo', {}],
  [1, 'PATCH', '/api/v1/calibration', {platform_from_sensor: settings.platform_from_sensor, scale: [1, 0, -1], sensor_map: [null, 1]}],
  [1, 'GET', '/api/v1/calibration/sensor-map'],
  [2, 'GET', '/api/v1/preview/points'], [2, 'GET', '/api/v1/turntable'],
  [1, 'POST', '/api/v1/turntable', {jog_deg: [10, 1e9], test: [true], stop: [true]}],
];
const totalWeight = routes.reduce((sum, [weight]) => sum + weight, 0);

function someRoute(random) {
  let at = random.below(totalWeight * 1000) / 1000;
  return routes.find(([weight]) => (at -= weight) < 0) ?? routes[0];
}

function someId(random, ids) {
  if (ids.length > 0 && random.chance(0.8)) {
    return random.pick(ids);
  }
  return random.pick(['20261121-081500-3f2a', 'x', '', '.', '..', '%2e%2e', '..%2f..', '%00', '%c0%ae', 'a'.repeat(3000), '20261121-081500-3f2a/..']);
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
 * @param {{ids: string[], port: number}} known  the server's scans and port
 * @returns {{bytes: Buffer, parts: number, ending: 'end'|'reset'}}  the bytes, the number of writes, and how the connection ends
 */
export function someRequest(random, known) {
  const [, usual, path, content] = someRoute(random);
  const method = random.chance(0.94) ? usual :
    random.pick(['HEAD', 'PUT', 'OPTIONS', 'TRACE', 'CONNECT', 'get', 'PROPFIND', 'G T', '', 'X'.repeat(200), 'POST', 'DELETE']);
  let target = path.replace('{id}', someId(random, known.ids)) + (random.chance(0.2) ? random.pick(queries) : '');
  if (random.chance(0.03)) {
    target = random.pick(['*', `http://127.0.0.1:${known.port}${target}`, `//${target}`, target.replaceAll('/', '//'), `${target}/`, `${target}#x`,
      `/..${target}`, target + '/x'.repeat(2000), encodeURIComponent(target), target.toUpperCase(), `${target}%`, 'ftp://x', '']);
  }
  const text = content === undefined ? '' : content === 'bytes' ? random.bytes(random.below(5000)) : someJson(random, content);
  const {header, sent} = framing(random, method, Buffer.from(text));
  const version = random.chance(0.98) ? 'HTTP/1.1' : random.pick(['HTTP/1.0', 'HTTP/2.0', 'HTTP/9.9', 'http/1.1', '']);
  const head = `${method} ${target} ${version}\r\n${headersOf(random, known.port, content === 'bytes')}${header}\r\n`;
  let bytes = Buffer.concat([Buffer.from(head, 'latin1'), sent]);
  while (random.chance(0.08) && bytes.length > 0) {
    bytes = damage(random, bytes);
  }
  const cut = random.chance(0.04);
  if (cut) {
    bytes = bytes.subarray(0, random.below(bytes.length + 1));
  }
  return {bytes, parts: random.chance(0.1) ? 1 + random.below(4) : 1, ending: random.chance(cut ? 0.5 : 0.02) ? 'reset' : 'end'};
}
