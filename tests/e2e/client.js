// A program that uses the scanner by a client that is generated from its OpenAPI description: client.test.js checks its types, and runs it.

import createClient from 'openapi-fetch';

/** The answer's data. @template T @param {{data?: T, error?: {code: string, detail: string}}} answer @returns {T} */
function dataOf({data, error}) {
  if (data === undefined) {
    throw new Error(error ? `${error.code}: ${error.detail}` : 'no data');
  }
  return data;
}

/**
 * Scans, builds another model, and puts the scan into the bin and back.
 * @param {string} baseUrl  of the scanner
 * @returns {Promise<{id: string, verdict: string | undefined, bytes: number, refused: string | undefined}>}
 */
export async function scanByClient(baseUrl) {
  /** @type {import('openapi-fetch').Client<import('./octurn.js').paths>} */
  const client = createClient({baseUrl});
  const {snapshots} = dataOf(await client.GET('/api/v1/settings')).defaults;
  const body = {snapshots: Math.min(snapshots ?? 36, 6), frames: 2, leaf_size_mm: 4};
  dataOf(await client.POST('/api/v1/scans/estimate', {body}));
  const started = await client.POST('/api/v1/scans', {body});
  const {id} = dataOf(started);
  if (started.response.headers.get('Location') !== `/api/v1/scans/${id}`) {
    throw new Error('no Location');
  }
  const params = {path: {id}};
  let scan = dataOf(await client.POST('/api/v1/scans/{id}/pause', {params}));
  while (scan.state === 'running') {  // until its stop is taken
    scan = dataOf(await client.GET('/api/v1/scans/{id}', {params}));
  }
  dataOf(await client.POST('/api/v1/scans/{id}/resume', {params}));
  do {
    scan = dataOf(await client.GET('/api/v1/scans/{id}', {params}));
  } while (scan.state === 'running');
  dataOf(await client.PATCH('/api/v1/scans/{id}', {params, body: {name: 'by a client'}}));

  const build = dataOf(await client.POST('/api/v1/scans/{id}/builds', {params, body: {leaf_size_mm: 8, choose: true}})).build;
  const ofBuild = {path: {id, number: build}};
  let built;
  do {
    built = dataOf(await client.GET('/api/v1/scans/{id}/builds/{number}', {params: ofBuild}));
  } while (built.state === 'waiting' || built.state === 'running');
  if (built.state !== 'finished') {
    throw new Error(`the build ${built.state}: ${built.error?.detail}`);
  }
  await client.DELETE('/api/v1/scans/{id}', {params});
  dataOf(await client.POST('/api/v1/scans/{id}/restore', {params}));
  const model = await client.GET('/api/v1/scans/{id}/Scan.stl', {params, parseAs: 'arrayBuffer'});
  const {error} = await client.POST('/api/v1/scans', {body: {snapshots: 0}});
  return {id, verdict: scan.model?.quality?.verdict, bytes: model.data?.byteLength ?? 0, refused: error?.code};
}
