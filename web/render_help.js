// Renders the scanner's help from the documents in docs: render_help.js DOCS_FOLDER OUTPUT_FOLDER FILE.md...
// Runs when the page is built. Links between these files stay links; a link to another file of the repository, which
// the scanner does not serve, is replaced by its text. FOLDER/README.md becomes FOLDER.html. NAME.LANGUAGE.md is a
// translation of NAME.md, with the same headings in the same order, which get the anchors of the original.

import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {basename, dirname, join} from 'node:path';
import {Marked} from 'marked';

const [docs, output, ...files] = process.argv.slice(2);
/** @param {string} path  of a document @returns {string} its page, without .html */
const nameOf = (path) => basename(path) === 'README.md' ? basename(dirname(path)) : basename(path, '.md').toLowerCase();
const names = files.map(nameOf);

/** Words of the frame around a document. @type {Record<string, {name: string, back: string, help: string}>} */
const frames = {
  en: {name: 'English', back: 'Back to the scanner', help: 'Help'},
  de: {name: 'Deutsch', back: 'Zurück zum Scanner', help: 'Hilfe'},
  es: {name: 'Español', back: 'Volver al escáner', help: 'Ayuda'},
  fr: {name: 'Français', back: 'Retour au scanner', help: 'Aide'},
};
/** @param {string} name @returns {[string, string]} the document and the language */
const partsOf = (name) => /** @type {[string, string]} */ ([...name.split('.'), 'en'].slice(0, 2));

/** The anchor of a heading as on GitHub, so that links into a document work in both places. @param {string} heading */
const anchorOf = (heading) => heading.toLowerCase().replace(/<[^>]*>/g, '').replace(/[^\p{L}\p{N}\- ]/gu, '').replaceAll(' ', '-');

/** @param {string} href @returns {string | null} its address on the scanner; null if there is none */
function addressOf(href) {
  const [, path, anchor = ''] = /^([^#]*)(#.*)?$/.exec(href) ?? [];
  if (/^(https?:|mailto:)/.test(href) || path === '') {
    return href;
  }
  const name = nameOf(path);
  if (name === 'api') {
    return '../interface.html';  // the scanner's page on the interface
  }
  if (/\.(svg|png)$/.test(path)) {
    return basename(path);
  }
  return path.endsWith('.md') && names.includes(name) ? `${name}.html${anchor}` : null;
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

/** The originals' anchors by document, as they are rendered first. @type {Map<string, string[]>} */
const anchors = new Map();

/** A document as HTML. @param {string} name @param {string} text */
function rendered(name, text) {
  const [document, language] = partsOf(name);
  const html = /** @type {string} */ (marked.parse(text));
  const heading = /(<h\d id=")([^"]*)/g;
  if (language === 'en') {
    anchors.set(document, [...html.matchAll(heading)].map(([, , anchor]) => anchor));
    return html;
  }
  const left = [...anchors.get(document) ?? []];
  const translated = html.replace(heading, (_, start) => start + (left.shift() ?? 'missing'));
  if (left.length > 0 || translated.includes('id="missing"')) {
    throw new Error(`${name} has other headings than ${document}`);
  }
  return translated;
}

/** Links to a document in its languages; nothing if it has one. @param {string} name */
function languageLinks(name) {
  const [document] = partsOf(name);
  const links = names.filter((other) => partsOf(other)[0] === document).map((other) => {
    const [, language] = partsOf(other);
    const current = other === name ? ' aria-current="page"' : '';
    return `<a href="${other}.html" lang="${language}" hreflang="${language}"${current}>${frames[language].name}</a>`;
  });
  return links.length > 1 ? `\n    <p class="languages">${links.join(' · ')}</p>` : '';
}

/** The list of all documents, in the reader's language where there is one. @param {string} name */
function documentLinks(name) {
  const [, language] = partsOf(name);
  return names.filter((other) => partsOf(other)[1] === 'en').map((other) => {
    const own = names.includes(`${other}.${language}`) ? `${other}.${language}` : other;
    const foreign = partsOf(own)[1] === language ? '' : ` lang="${partsOf(own)[1]}"`;
    const current = own === name ? ' aria-current="page"' : '';
    return `<li><a href="${own}.html"${foreign}${current}>${titleOf(texts[names.indexOf(own)])}</a></li>`;
  }).join('\n      ');
}

mkdirSync(output, {recursive: true});
texts.forEach((text, index) => {
  const [, language] = partsOf(names[index]);
  const {back, help} = frames[language];
  writeFileSync(join(output, `${names[index]}.html`), `<!doctype html>
<html lang="${language}">
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
  <nav aria-label="${help}">
    <p><a href="../">${back}</a></p>${languageLinks(names[index])}
    <ul>
      ${documentLinks(names[index])}
    </ul>
  </nav>
  <main>
${scrolling(rendered(names[index], text))}
  </main>
</body>
</html>
`);
});
