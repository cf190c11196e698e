// "Compare" below a scan: its model in view against an STL, or against another model of the scan.

import * as api from '../api/api.js';
import {element, list, part, setText, setVerbatim, show} from '../base/dom.js';
import * as format from '../base/format.js';
import {awaitFragment} from '../base/fragment.js';
import {colourOf, coloursOf, figuresOf} from '../model/deviation.js';
import {readReference} from '../model/reference.js';
import {text} from '../base/texts.js';
import {state} from '../page.js';
import {screenOf} from '../screen.js';
import {modelPicture, paintModel} from './stage.js';

/** @typedef {import('../model/deviation.js').Deviations} Deviations */

const height = 100;  // of the histogram, in units of its view box
const barWidth = 10;

let isHere = false;  // whether the fragment is loaded
let current = '';  // the model in view
let place = '';  // how the model in view was laid and scaled
let other = '';  // name of the reference
/** @type {Pick<Deviations, 'distances' | 'weights'> | null} of the model in view */
let result = null;
/** @type {Worker | null} */
let worker = null;

const tolerance = () => element('compare-tolerance').valueAsNumber;

/** @param {string} words @param {'bad' | ''} [tone] */
function say(words, tone = '') {
  setText(element('compare-said'), words);
  element('compare-said').dataset.tone = tone;
}

/**
 * Figures in words. Pure.
 * @param {ReturnType<typeof figuresOf>} figures @param {number} limit  tolerance, millimetres
 */
export const factsOf = ({mean, bias, rms, max, within}, limit) => [
  {label: text('compare.within', {tolerance: format.millimetres(limit)}), text: format.percent(within, 1)},
  {label: text('compare.mean'), text: format.millimetres(mean, 3)},
  {label: text('compare.bias'), text: `${bias > 0 ? '+' : ''}${format.millimetres(bias, 3)}`},
  {label: text('compare.rms'), text: format.millimetres(rms, 3)},
  {label: text('compare.max'), text: format.millimetres(max)},
];

/** @param {number[]} shares  of the bars @param {number} limit  tolerance */
function drawHistogram(shares, limit) {
  const most = Math.max(...shares, 1e-9);
  element('compare-histogram').replaceChildren(...shares.map((share, i) => {
    const bar = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
    const middle = ((i + 0.5) / shares.length * 2 - 1) * 3 * limit;
    const tall = height * share / most;
    const sides = {x: i * barWidth, y: height + 6 - tall, width: barWidth - 1, height: tall, fill: `rgb(${colourOf(middle, limit)})`};
    Object.entries(sides).forEach(([name, value]) => bar.setAttribute(name, String(value)));
    return bar;
  }));
  setText(element('compare-min'), `≤ ${format.millimetres(-3 * limit)}`);
  setText(element('compare-max'), `≥ +${format.millimetres(3 * limit)}`);
}

/** Shows the result in colour and in figures. */
function showResult() {
  show(element('compare-result'), result !== null);
  if (!result || !(tolerance() > 0)) {
    return;
  }
  const figures = figuresOf(result, tolerance());
  setVerbatim(element('compare-name'), element('details-name').textContent ?? '');
  setText(element('compare-with'), text('compare.with', {reference: other, when: format.when(new Date().toISOString())}));
  list(element('compare-facts'), factsOf(figures, tolerance()), ({label}) => label, 'fact', (item, {label, text: words}) => {
    setText(part(item, 'dt'), label);
    setText(part(item, 'dd'), words);
  });
  drawHistogram(figures.histogram, tolerance());
  paintModel(current, coloursOf(result, tolerance()));
}

/** Ends what is under way, and forgets the result. */
function forget() {
  worker?.terminate();
  worker = null;
  if (result) {
    paintModel(current, null);
  }
  result = null;
  element('compare-start').removeAttribute('aria-disabled');
  say('');
  show(element('compare-result'), false);
}

/** @param {string | Blob} source  an address, or a file */
async function read(source) {
  const stream = typeof source === 'string' ? await api.model(source, new AbortController().signal) : source.stream();
  return readReference(new Uint8Array(await new Response(stream).arrayBuffer()));
}

async function compare() {
  const [file] = element('compare-file').files;
  const build = element('compare-build');
  const reference = file ?? build.value;
  if (!reference) {
    say(text('compare.choose'), 'bad');
    return;
  }
  forget();
  other = file ? file.name : build.selectedOptions[0].text;
  say(text('compare.going'));
  element('compare-start').setAttribute('aria-disabled', 'true');
  const mine = worker = new Worker(new URL('./compare_worker.js', import.meta.url), {type: 'module'});
  try {
    const [model, wanted] = await Promise.all([current, reference].map(read));
    const compared = new Promise((done, fail) => {
      mine.onmessage = ({data}) => done(data);
      mine.onerror = () => fail(new Error(text('compare.failed')));
    });
    const isPlaced = !file && build.selectedOptions[0].dataset.place === place;
    mine.postMessage({model, reference: wanted, isPlaced}, [model.positions.buffer, wanted.positions.buffer]);
    const found = await compared;
    if (worker === mine) {
      result = /** @type {any} */ (found);
      say('');
      showResult();
    }
  } catch (error) {
    worker === mine && say(format.sentence(error instanceof Error ? error.message : String(error)), 'bad');
  } finally {
    mine.terminate();
    if (worker === mine) {
      worker = null;
      element('compare-start').removeAttribute('aria-disabled');
    }
  }
}

/** Prints a copy of the result, with the picture, in place of the page. */
async function print() {
  const report = element('compare-report').cloneNode(true);
  report.id = 'compare-printed';
  const picture = part(report, 'img');
  const address = modelPicture();
  picture.src = address;
  show(picture, address !== '');
  document.body.append(report);
  await picture.decode().catch(() => {});
  globalThis.print();
  report.remove();
}

/** Follows the model in view. */
export function showCompare() {
  const {stage: {model}, builds} = screenOf(state);
  show(element('compare'), model !== null);
  if (!isHere) {
    return;
  }
  if ((model?.url ?? '') !== current) {
    forget();
    current = model?.url ?? '';
  }
  place = builds?.rows.find(({isShown}) => isShown)?.place ?? '';
  const others = (builds?.rows ?? []).filter(({isShown}) => !isShown);
  show(element('compare-builds'), others.length > 0);
  const none = {number: -1, name: text('compare.no-build'), download: '', place: ''};
  list(element('compare-build'), [none, ...others], ({number}) => String(number), 'compare-option',
      (option, row) => {
        setText(option, row.name);
        option.value = row.download;
        option.dataset.place = row.place;
      });
}

/** Names the chosen file on its button. */
function nameFile() {
  const [file] = element('compare-file').files;
  setVerbatim(element('compare-chosen'), file?.name ?? text('compare.file'));
}

/** Fetches the fragment, and attaches its handlers. */
export async function prepareCompare() {
  await awaitFragment(element('compare'), 'compare.html');
  isHere = true;
  element('compare-form').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    element('compare-start').getAttribute('aria-disabled') !== 'true' && compare();
  });
  element('compare-file').addEventListener('change', () => {
    element('compare-build').value = element('compare-file').files.length > 0 ? '' : element('compare-build').value;
    nameFile();
  });
  element('compare-build').addEventListener('change', () => {
    element('compare-file').value = element('compare-build').value ? '' : element('compare-file').value;
    nameFile();
  });
  element('compare-tolerance').addEventListener('input', showResult);
  element('compare-print').addEventListener('click', print);
  showCompare();
}
