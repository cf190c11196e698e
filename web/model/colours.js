// The colours of a model, in the order of its STL: three corners for each triangle.

import * as api from '../api/api.js';
import {element, pressed, show} from '../base/dom.js';
import {sentence} from '../base/format.js';
import {text} from '../base/texts.js';

const vertexBytes = 15;  // x, y, z as floats; red, green, blue
const headEnd = '\nend_header\n';
const maxHead = 4000;  // bytes; its comments are the name, the number, the author and the licence, of 100 characters each
const faceBytes = 14;  // number of corners, three vertex indices, whether it was filled in

/**
 * Reads a coloured PLY of the scanner. Its faces are the STL's, in the same order.
 * @param {ArrayBuffer} file
 * @returns {Uint8Array} nine levels for each triangle: red, green and blue of its corners
 * @throws {Error} if the file is truncated or not such a PLY
 */
export function readColours(file) {
  const bytes = new Uint8Array(file);
  const head = new TextDecoder('latin1').decode(bytes.subarray(0, maxHead)).split(headEnd)[0];
  const count = (/** @type {string} */ name) => Number(new RegExp(`^element ${name} (\\d+)`, 'm').exec(head)?.[1]);
  const vertices = head.length + headEnd.length;
  const faces = vertices + count('vertex') * vertexBytes;
  if (!head.includes('property uchar red') || bytes.length !== faces + count('face') * faceBytes) {
    throw new Error(text('view.stl-short'));
  }
  const view = new DataView(file);
  const colours = new Uint8Array(9 * count('face'));
  for (let face = 0, to = 0; face < count('face'); ++face) {
    for (let corner = 0; corner < 3; ++corner, to += 3) {
      const from = vertices + view.getUint32(faces + face * faceBytes + 1 + 4 * corner, true) * vertexBytes + 12;
      colours.set(bytes.subarray(from, from + 3), to);
    }
  }
  return colours;
}

/**
 * What colours show: the object's own, or how many snapshots saw each place. Also the id of its button.
 * @typedef {'colours' | 'views'} Paint
 */

/** @param {string} url  of a model's STL @param {Paint} paint @returns {Promise<Uint8Array>} as from `readColours` */
async function fetchColours(url, paint) {
  const query = paint === 'views' ? 'views' : 'true';
  const stream = await api.model(url.replace(/stl$/, `ply?colour=${query}`), new AbortController().signal);
  return readColours(await new Response(stream).arrayBuffer());
}

/** @param {Paint} paint */
const isPressed = (paint) => element(paint).getAttribute('aria-pressed') === 'true';

/** @param {Paint} paint @param {boolean} isShown */
function press(paint, isShown) {
  pressed(paint, isShown);
  show(element('legend'), isShown && paint === 'views');
}

/**
 * Shows or hides the model's colours.
 * @param {Object} shown
 * @param {() => import('./viewer.js').Viewer | undefined} shown.viewer
 * @param {() => {url: string | null, paint: Paint | null}} shown.painted  the STL of the shown model
 * @param {(words: string) => void} shown.say
 */
export async function togglePaint({viewer, painted, say}) {
  const {url, paint} = painted();
  if (paint === null) {
    return;  // its button is hidden
  }
  press(paint, !isPressed(paint));
  if (!isPressed(paint) || url === null) {
    viewer()?.paint(null);
    return;
  }
  say(text('view.loading'));
  try {
    const colours = await fetchColours(url, paint);
    if (painted().url === url && isPressed(paint)) {  // unless another model is shown by now
      viewer()?.paint(colours);
    }
    say('');
  } catch (error) {
    const isStill = painted().url === url;
    if (isStill) {
      press(paint, false);
    }
    say(isStill ? sentence(error instanceof Error ? error.message : String(error)) : '');
  }
}
