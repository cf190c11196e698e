// Renders the scanner's help from the documents in docs: render_help.js DOCS_FOLDER OUTPUT_FOLDER FILE.md...
// Runs when the page is built. Links between these files stay links; a link to another file of the repository, which the scanner does
// not serve, is replaced by its text.

import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {basename, join} from 'node:path';
import {Marked} from 'marked';

const [docs, output, ...files] = process.argv.slice(2);
const names = files.map((file) => basename(file, '.md').toLowerCase());

/** The anchor of a heading as on GitHub, so that links into a document work in both places. @param {string} heading */
const anchorOf = (heading) => heading.toLowerCase().replace(/<[^>]*>/g, '').replace(/[^\p{L}\p{N}\- ]/gu, '').replaceAll(' ', '-');

/** @param {string} href @returns {string | null} its address on the scanner; null if there is none */
function addressOf(href) {
  const [, path, anchor = ''] = /^([^#]*)(#.*)?$/.exec(href) ?? [];
  if (/^(https?:|mailto:)/.test(href) || path === '') {
    return href;
  }
  const name = basename(path, '.md').toLowerCase();
  if (name === 'api') {
    return '../interface.html';  // the scanner's page on the interface
  }
  return path.endsWith('.md') && names.includes(name) ? `${name}.html${anchor}` : path.endsWith('.svg') ? path : null;
}

const marked = new Marked({
  renderer: {
    heading({tokens, depth}) {
      const text = this.parser.parseInline(tokens);
      return `<h${depth} id="${anchorOf(text)}">${text}</h${depth}>\n`;
    },
    link({href, tokens}) {
      const text = this.parser.parseInline(tokens);
      const address = addressOf(href);
      return address === null ? text : `<a href="${address}">${text}</a>`;
    },
  },
});

/** Makes tables and code blocks scrollable on narrow screens. An empty header cell becomes a data cell, as it has nothing to read out. @param {string} html */
const scrolling = (html) => html
    .replace(/<th([^>]*)><\/th>/g, '<td$1></td>')
    .replaceAll('<table>', '<div class="wide" tabindex="0"><table>').replaceAll('</table>', '</table></div>')
    .replaceAll('<pre>', '<pre class="wide" tabindex="0">');

const titleOf = (/** @type {string} */ text) => /^# (.*)$/m.exec(text)?.[1].replaceAll('`', '') ?? '';
const texts = files.map((file) => readFileSync(join(docs, file), 'utf8'));

mkdirSync(output, {recursive: true});
texts.forEach((text, index) => {
  const links = texts.map((other, at) =>
    `<li><a href="${names[at]}.html"${at === index ? ' aria-current="page"' : ''}>${titleOf(other)}</a></li>`).join('\n      ');
  writeFileSync(join(output, `${names[index]}.html`), `<!doctype html>
<html lang="en">
<head>
  <meta charset="utf-8">
  <meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">
  <meta name="color-scheme" content="light dark">
  <title>${titleOf(text)} · Octurn</title>
  <script src="../theme.js"></script>
  <link rel="icon" href="../icons/octurn.svg" type="image/svg+xml">
  <link rel="stylesheet" href="../style.css">
  <link rel="stylesheet" href="../help.css">
</head>
<body class="help">
  <nav aria-label="Help">
    <p><a href="../">Back to the scanner</a></p>
    <ul>
      ${links}
    </ul>
  </nav>
  <main>
${scrolling(/** @type {string} */ (marked.parse(text)))}
  </main>
</body>
</html>
`);
});
