// Texts for an OpenAPI description.

/** @typedef {{method: string, path: string, summary: string, description: string, operation: any}} Operation */

/** The operations by their tags, in the order of the description. @param {any} description @returns {Map<string, Operation[]>} */
export function operationsOf({paths}) {
  const byTag = new Map();
  for (const [path, item] of Object.entries(paths)) {
    for (const [method, operation] of Object.entries(/** @type {any} */ (item))) {
      if (method !== 'parameters') {
        const tag = operation.tags[0];
        byTag.set(tag, [...byTag.get(tag) ?? [],
          {method, path, summary: operation.summary, description: (operation.description ?? '').replaceAll('`', ''), operation}]);
      }
    }
  }
  return byTag;
}

/** The type of a schema in words, such as "Scan or null", "list of Point". @param {any} schema @returns {string} */
export function typeText(schema) {
  if (schema.$ref) {
    return schema.$ref.split('/').at(-1);
  }
  if (schema.oneOf) {
    return schema.oneOf.map(typeText).join(' or ');
  }
  if (schema.allOf) {
    return schema.allOf.map(typeText).join(' and ');
  }
  if (schema.enum) {
    return schema.enum.map((/** @type {any} */ value) => JSON.stringify(value)).join(' | ');
  }
  if ('const' in schema) {
    return JSON.stringify(schema.const);
  }
  if (schema.type === 'array') {
    return `list of ${typeText(schema.items ?? {})}`;
  }
  if (schema.type === 'object' && schema.properties) {
    return `{${Object.entries(schema.properties).map(([key, value]) => `${key}: ${typeText(value)}`).join(', ')}}`;
  }
  return [schema.type ?? 'anything'].flat().join(' or ');
}

/** @param {any} content  by media type */
const contentText = (content) => Object.entries(content)
    .map(([type, {schema}]) => schema ? typeText(schema) : type).join(', ');

/** The request body of an operation in words, or empty. @param {any} operation @returns {string} */
export const bodyOf = ({requestBody}) => requestBody ? contentText(requestBody.content) : '';

/** The responses of an operation in words, by status. @param {any} operation @returns {[string, string][]} */
export const answersOf = ({responses}) => Object.entries(responses).map(([code, answer]) => [
  code, answer.$ref ? answer.$ref.split('/').at(-1) : answer.content ? contentText(answer.content) : answer.description]);
