import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

const {paths, components} = JSON.parse(readFileSync(`${process.env.OCTURN_SOURCE}/web/openapi.json`, 'utf8'));
const words = readFileSync(`${process.env.OCTURN_SOURCE}/web/API.md`, 'utf8');
const rows = words.split('\n').filter((line) => /^\| `(GET|POST|PUT|PATCH|DELETE)\b/.test(line));

/** The operations that a row's first cell names: "`POST a`, `b`" names two. @param {string} cell @returns {string[]} */
function operationsOf(cell) {
  let method = '';
  return [...cell.matchAll(/`([^`]*)`/g)].flatMap(([, text]) => {
    const [, verb, path] = /^(?:([A-Z]+)\b ?)?(.*)$/.exec(text);
    method = verb === 'HEAD' ? 'GET' : verb ?? method;
    const bare = path.split('?')[0].replace('{build}', '{number}');
    return bare ? [`${method} ${bare.startsWith('/') ? bare : `/api/v1/${bare}`}`] : [];
  });
}

/** The refusals that a text names, such as "409 busy". @param {string} text @returns {string[]} */
const refusalsOf = (text) => [...text.matchAll(/\b([45]\d\d) ((?:`[a-z*-]+`(?:,? or |, )?)+)/g)]
    .flatMap(([, status, codes]) => [...codes.matchAll(/`([a-z*-]+)`/g)].map(([, code]) => `${status} ${code}`));

/** What the description says of a response, with what it refers to. @param {any} response */
const described = (response) => response.description ?? components.responses[response.$ref.split('/').at(-1)].description;

test('the document names the operations of the description, and their answers', () => {
  const named = new Set();
  for (const row of rows) {
    const [cell, ...rest] = row.slice(2).split(' | ');
    const answer = rest.join(' | ');
    for (const operation of new Set(operationsOf(cell))) {
      named.add(operation);
      const [method, path] = operation.split(' ');
      const {responses} = paths[path]?.[method.toLowerCase()] ?? assert.fail(operation);
      const success = /(?:^|[.:;,] )(20[0-6])\b/.exec(answer)?.[1];
      assert.ok(!success || responses[success], `${operation}: ${success}`);
      for (const refusal of refusalsOf(answer)) {
        const [status, code] = refusal.split(' ');
        assert.ok(responses[status] && described(responses[status]).includes(`\`${code}\``), `${operation}: ${refusal}`);
      }
      if (answer.includes('`Location`')) {
        assert.ok(responses[201]?.headers?.Location ?? responses[202]?.headers?.Location, `${operation}: Location`);
      }
    }
  }
  const all = Object.entries(paths).flatMap(([path, item]) =>
    Object.keys(item).filter((method) => method !== 'parameters').map((method) => `${method.toUpperCase()} ${path}`));
  const likewise = all.filter((operation) => /builds\/\{number\}\/(Scan\.\{format\}|coarse\.stl)$/.test(operation));
  assert.deepEqual(all.filter((operation) => !named.has(operation)), likewise);
});

/** The names of all values in a part of the description. @param {any} part @returns {string[]} */
const valuesOf = (part) => part === null || typeof part !== 'object' ? [] :
  [...Object.keys(part.properties ?? {}), ...Object.values(part).flatMap(valuesOf)];

test('the document names every value of the description', () => {
  const values = new Set(valuesOf({paths, components}));
  assert.ok(values.size > 150);
  assert.deepEqual([...values].filter((value) => !new RegExp(`["\`]${value}["\`=]`).test(words)), []);
});

test('the description refuses with codes that there are', () => {
  const codes = components.schemas.Problem.properties.code.enum;
  for (const [path, item] of Object.entries(paths)) {
    for (const {responses = {}} of Object.values(item)) {
      for (const [status, response] of Object.entries(responses).filter(([key]) => /^[45]/.test(key))) {
        for (const [, code] of described(response).matchAll(/`([a-z*-]+)`/g)) {
          assert.ok(code.endsWith('*') || codes.includes(code), `${path} ${status} ${code}`);
        }
      }
    }
  }
});
