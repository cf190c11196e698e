// Builds the served page from its modules: node bundle.js SOURCE TARGET FILE...
//
// The scripts and styles of each document become a few files under assets/, whose names contain a hash of the content,
// so that browsers may cache them for ever. Included fragments are inlined into their document. Other files are copied.
// Each text file is also stored compressed, as NAME.gz.

import {build} from 'esbuild';
import {cp, mkdir, readFile, readdir, rm, writeFile} from 'node:fs/promises';
import {basename, dirname, join, relative} from 'node:path';
import {gzipSync} from 'node:zlib';

const [source, target, ...files] = process.argv.slice(2);
const include = /^ *<!--#include file="([^"]+)" -->\n/gm;
const stylesheet = /^ *<link rel="stylesheet" href="([^"]+)">\n/gm;
const script = /<script type="module" src="([^"]+)"><\/script>/;
const plainScript = /<script src="([^"]+)"><\/script>/g;  // runs before the document is drawn
const preload = /^ *<link rel="modulepreload"[^>]*>\n/gm;
const indentation = /^ +/gm;  // dropped from documents with a script, none of which has preformatted text
const packed = /\.(html|css|js|json|svg|txt|webmanifest)$/;

const workerUrl = /new URL\('([^']+)', import\.meta\.url\)/g;

/** Bundles the worker of each `new Worker(new URL('FILE', import.meta.url))`. */
const bundleWorkers = {name: 'workers', setup: ({onLoad}) => {
  onLoad({filter: /\.js$/, namespace: 'file'}, async ({path}) => {
    const text = await readFile(path, 'utf8');
    const made = new Map();
    for (const [, name] of text.matchAll(workerUrl)) {
      const {metafile} = await build({...common, entryPoints: [join(dirname(path), name)]});
      made.set(name, basename(Object.keys(metafile.outputs)[0]));
    }
    return made.size === 0 ? undefined :
      {contents: text.replace(workerUrl, (_, name) => `new URL('./${made.get(name)}', import.meta.url)`)};
  });
}};
const lightDark = /light-dark\(((?:[^(),]|\([^()]*\))+),((?:[^(),]|\([^()]*\))+)\)/g;

/** Gives both schemes to browsers without light-dark(), which came in 2024. */
const spellSchemes = {name: 'schemes', setup: ({onLoad}) => {
  onLoad({filter: /\/style\.css$/}, async ({path}) => {
    const text = await readFile(path, 'utf8');
    const colours = [...text.matchAll(/--[a-z-]+: [^;]*light-dark[^;]*;/g)].map(([colour]) => colour).join('');
    const [light, dark] = ['$1', '$2'].map((one) => colours.replace(lightDark, one));
    return {loader: 'css', contents: `${text}@supports not (color: light-dark(red, red)) {
      :root { ${light} }
      @media (prefers-color-scheme: dark) { :root:not([data-theme=light]) { ${dark} } }
      :root[data-theme=dark] { ${dark} }
    }`};
  });
}};
const common = {
  bundle: true, minify: true, format: 'esm', target: 'es2022', charset: 'utf8', legalComments: 'none', logLevel: 'warning',
  metafile: true, absWorkingDir: source, outdir: join(target, 'assets'), entryNames: '[name]-[hash]', chunkNames: '[name]-[hash]',
};

/** The output file of an entry point, from `outputs` of a metafile. @returns {string} */
function madeOf(outputs, entry) {
  const [path] = Object.entries(outputs).find(([, {entryPoint}]) => entryPoint === entry);
  return path;
}

/** A script and its static imports, the script first; paths below `target`. @returns {string[]} */
function needed(outputs, path, seen = []) {
  if (!seen.includes(path)) {
    seen.push(path);
    outputs[path].imports.filter(({kind}) => kind === 'import-statement').forEach((other) => needed(outputs, other.path, seen));
  }
  return seen;
}

/** @param {string} path  of esbuild, relative to `source` */
const fromPage = (path) => relative(target, join(source, path));

/** Bundles a document's stylesheets into one file, in their order. @param {string[]} files @returns {Promise<string>} */
async function bundleStyles(files) {
  const contents = files.map((file) => `@import "./${file}";`).join('\n');
  const {metafile} = await build({
    ...common, entryNames: `${basename(files.at(-1), '.css')}-[hash]`, external: ['icons/*'], plugins: [spellSchemes],
    stdin: {contents, loader: 'css', resolveDir: source, sourcefile: 'document.css'}});
  return fromPage(Object.keys(metafile.outputs)[0]);
}

/** @param {string} folder @returns {Promise<string[]>} all files below it */
async function filesBelow(folder) {
  const entries = await readdir(folder, {withFileTypes: true});
  const below = await Promise.all(entries.map((entry) => entry.isDirectory() ?
    filesBelow(join(folder, entry.name)) : [join(folder, entry.name)]));
  return below.flat();
}

/** @type {Set<string>} files inlined into others */
const included = new Set();

/** @param {string} file @returns {Promise<string>} its text, with the included fragments */
async function textOf(file) {
  const text = await readFile(join(source, file), 'utf8');
  const pieces = new Map();
  for (const [line, name] of text.matchAll(include)) {
    const piece = join(dirname(file), name);
    included.add(piece);
    pieces.set(line, await textOf(piece));
  }
  return text.replace(include, (line) => pieces.get(line));
}

await rm(target, {recursive: true, force: true});
await mkdir(target, {recursive: true});
const documents = new Map();
for (const file of files.filter((name) => !/\.(js|css)$/.test(name))) {
  await mkdir(join(target, dirname(file)), {recursive: true});
  if (file.endsWith('.html')) {
    documents.set(file, await textOf(file));
  } else {
    await cp(join(source, file), join(target, file));
  }
}
included.forEach((file) => documents.delete(file));

const plainScripts = new Set([...documents].flatMap(([file, text]) =>
  [...text.matchAll(plainScript)].map(([, name]) => join(dirname(file), name))));
await Promise.all([...plainScripts].map((file) => cp(join(source, file), join(target, file))));

const entries = [...documents.values()].flatMap((text) => script.exec(text)?.[1] ?? []);
const {metafile: {outputs}} = await build(
    {...common, entryPoints: entries, splitting: true, plugins: [bundleWorkers]});
for (const [file, text] of documents) {
  const folder = dirname(file);
  const entry = script.exec(text)?.[1];
  const [main, ...others] = entry ? needed(outputs, madeOf(outputs, entry)).map(fromPage) : [];
  const styles = [...text.matchAll(stylesheet)].map(([, name]) => join(folder, name));
  const head = [
    ...styles.length > 0 ? [`  <link rel="stylesheet" href="${relative(folder, await bundleStyles(styles))}">`] : [],
    ...others.map((other) => `  <link rel="modulepreload" href="${other}">`), ''].join('\n');
  const bare = text.replace(preload, '');
  const first = Math.max(bare.search(stylesheet), 0);
  const rest = bare.replace(stylesheet, '').replace(script, `<script type="module" src="${main}"></script>`);
  const whole = rest.slice(0, first) + head + rest.slice(first);
  await writeFile(join(target, file), entry ? whole.replace(indentation, '') : whole);
}

for (const file of await filesBelow(target)) {
  const content = await readFile(file);
  const small = gzipSync(content, {level: 9});
  if (packed.test(file) && small.length < content.length) {
    await writeFile(`${file}.gz`, small);
  }
}
