// Where the scanner answers: from where the page is, as a proxy may serve it in a folder.

export const root = 'api/v1/';

/**
 * Parses an answer. Its addresses begin at the scanner's root: they become ones from where the page is.
 *
 * @param {string} body
 */
export const parse = (body) => JSON.parse(body, (key, value) => {
  const isOurs = key === 'url' && value?.startsWith?.(`/${root}`);
  return isOurs ? value.slice(1) : value;
});
