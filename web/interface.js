// Shows openapi.json as a page for programmers.

import {copyOf, element, part, setText, show} from './base/dom.js';
import {answersOf, bodyOf, operationsOf, typeText} from './api/openapi.js';

/** @param {Element} list @param {string} term @param {string} text */
function addRow(list, term, text) {
  const name = document.createElement('dt');
  const value = document.createElement('dd');
  name.textContent = term;
  value.textContent = text;
  list.append(name, value);
}

/** @param {import('./api/openapi.js').Operation} operation */
function operationItem({method, path, summary, description, operation}) {
  const item = copyOf('operation');
  const name = part(item, '.method');
  name.dataset.method = method;
  setText(name, method.toUpperCase());
  setText(part(item, 'code'), path);
  setText(part(item, '.what'), summary);
  setText(part(item, '.more'), description);
  const list = part(item, 'dl');
  for (const {name: key, description: text} of operation.parameters ?? []) {
    addRow(list, key, text);
  }
  const body = bodyOf(operation);
  if (body) {
    addRow(list, 'Body', body);
  }
  answersOf(operation).forEach(([code, text]) => addRow(list, code === 'default' ? 'Otherwise' : code, text));
  return item;
}

/** @param {string} name @param {any} schema */
function schemaItem(name, schema) {
  const item = copyOf('operation');
  part(item, '.method').remove();
  setText(part(item, 'code'), name);
  setText(part(item, '.what'), (schema.description ?? '').replaceAll('`', ''));
  const list = part(item, 'dl');
  Object.entries(schema.properties ?? {}).forEach(([key, value]) => addRow(list, key, typeText(value)));
  return item;
}

async function showDescription() {
  const response = await fetch('api/v1/openapi.json', {cache: 'no-cache'});
  if (!response.ok) {
    throw new Error(`${response.status}`);
  }
  const description = await response.json();
  setText(element('about'), description.info.description.replaceAll('`', ''));
  for (const [tag, operations] of operationsOf(description)) {
    const heading = document.createElement('h2');
    heading.textContent = tag;
    element('operations').append(heading, ...operations.map(operationItem));
  }
  element('schemas').append(...Object.entries(description.components.schemas).map(([name, schema]) => schemaItem(name, schema)));
}

showDescription().catch(() => show(element('interface-trouble'), true));
