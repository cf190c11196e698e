import assert from 'node:assert/strict';
import {test} from 'node:test';

import * as api from '../../web/api/api.js';

/** Mocks fetch: it resolves to `response`, or throws it. @returns the requests made */
function answering(t, response) {
  const requests = [];
  t.mock.method(globalThis, 'fetch', async (path, options) => {
    requests.push({path, ...options});
    if (response instanceof Error) {
      throw response;
    }
    return response;
  });
  return requests;
}

const json = (body, status = 200, type = 'application/json') => new Response(JSON.stringify(body), {status, headers: {'Content-Type': type}});

test('a scan is started with its settings as JSON', async (t) => {
  const requests = answering(t, json({id: 'one'}, 202));
  assert.deepEqual(await api.start({snapshots: 8}), {id: 'one'});
  const [{path, method, headers, body}] = requests;
  assert.deepEqual({path, method, headers, body},
      {path: 'api/v1/scans', method: 'POST', headers: {'Content-Type': 'application/json'}, body: '{"snapshots":8}'});
});

test('every unsafe request says that it is JSON, and names its scan', async (t) => {
  const requests = answering(t, new Response(null, {status: 204}));
  await api.remove('../a b');
  assert.equal(requests[0].path, 'api/v1/scans/..%2Fa%20b');
  assert.equal(requests[0].headers['Content-Type'], 'application/json');
});

test('the addresses of an answer are ones from where the page is, and other texts stay', async (t) => {
  answering(t, json({scans: [{name: '/api/v1/a', model: {url: '/api/v1/scans/one/Scan.stl'}}, {url: 'http://printer'}, {url: null}]}));
  assert.deepEqual(await api.scans(), [{name: '/api/v1/a', model: {url: 'api/v1/scans/one/Scan.stl'}}, {url: 'http://printer'}, {url: null}]);
});

test('a cancel has an empty body', async (t) => {
  const requests = answering(t, json({id: 'one'}, 202));
  await api.cancel('one');
  assert.equal(`${requests[0].method} ${requests[0].path} ${requests[0].body}`, 'POST api/v1/scans/one/cancel {}');
});

test('a scan is resumed by its name', async (t) => {
  const requests = answering(t, json({id: 'one'}, 202));
  assert.deepEqual(await api.resume('one'), {id: 'one'});
  assert.equal(`${requests[0].method} ${requests[0].path}`, 'POST api/v1/scans/one/resume');
});

test('a problem arrives in the words of the scanner', async (t) => {
  answering(t, json({title: 'Busy', code: 'busy', detail: 'a scan is running', hint: 'Wait.'}, 409, 'application/problem+json'));
  await assert.rejects(api.start({}), {name: 'Problem', code: 'busy', title: 'Busy', detail: 'a scan is running', hint: 'Wait.'});
});

test('an error page of something else is a problem too', async (t) => {
  answering(t, new Response('<h1>Bad gateway</h1>', {status: 502, headers: {'Content-Type': 'text/html'}}));
  await assert.rejects(api.status(), {code: 'http', title: 'The scanner answered 502'});
});

test('no answer, and an answer that is cut short, mean that the scanner cannot be reached', async (t) => {
  answering(t, new TypeError('fetch failed'));
  await assert.rejects(api.status(), {code: 'unreachable'});
  t.mock.restoreAll();
  answering(t, new Response('{"scan": nul', {headers: {'Content-Type': 'application/json'}}));
  await assert.rejects(api.status(), {code: 'unreachable'});
});

test('a model that is no longer wanted is no problem of the scanner', async (t) => {
  const gone = new DOMException('aborted', 'AbortError');
  answering(t, gone);
  await assert.rejects(api.model('/Scan.stl', AbortSignal.abort()), gone);
});
