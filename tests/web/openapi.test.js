import assert from 'node:assert/strict';
import {test} from 'node:test';

import {answersOf, bodyOf, operationsOf, typeText} from '../../web/api/openapi.js';

const scan = {$ref: '#/components/schemas/Scan'};

test('a type is told in words', () => {
  assert.equal(typeText(scan), 'Scan');
  assert.equal(typeText({oneOf: [scan, {type: 'null'}]}), 'Scan or null');
  assert.equal(typeText({allOf: [scan, scan]}), 'Scan and Scan');
  assert.equal(typeText({type: ['string', 'null']}), 'string or null');
  assert.equal(typeText({type: 'array', items: scan}), 'list of Scan');
  assert.equal(typeText({enum: ['ok', 'fault']}), '"ok" | "fault"');
  assert.equal(typeText({type: 'object', properties: {scans: {type: 'array', items: scan}}}), '{scans: list of Scan}');
});

test('operations go by their tag, and parameters of a path are none', () => {
  const get = {tags: ['scans'], summary: 'A scan', responses: {}};
  const post = {tags: ['builds'], summary: 'Build', responses: {}};
  const byTag = operationsOf({paths: {'/scans/{id}': {parameters: [{}], get}, '/builds': {post}}});
  assert.deepEqual([...byTag.keys()], ['scans', 'builds']);
  assert.deepEqual(byTag.get('scans').map(({method, path}) => [method, path]), [['get', '/scans/{id}']]);
});

test('a body and the answers are told', () => {
  const operation = {
    requestBody: {content: {'application/json': {schema: scan}}},
    responses: {
      202: {description: 'Begun', content: {'application/json': {schema: scan}}},
      204: {description: 'It is gone'},
      default: {$ref: '#/components/responses/Problem'},
    },
  };
  assert.equal(bodyOf(operation), 'Scan');
  assert.equal(bodyOf({}), '');
  assert.deepEqual(answersOf(operation), [['202', 'Scan'], ['204', 'It is gone'], ['default', 'Problem']]);
  assert.deepEqual(answersOf({responses: {200: {description: 'The model', content: {'model/stl': {}}}}}), [['200', 'model/stl']]);
});
