// A worker that reads the live pictures.

import {readPicture} from './live_reader.js';

const Canvas = /** @type {any} */ (globalThis).OffscreenCanvas;  // which not every TypeScript knows

onmessage = async ({data}) => {
  try {
    const reading = await readPicture(new Canvas(data.width, data.height), data);
    postMessage(reading, {transfer: [reading.pixels.buffer]});
  } catch (error) {
    postMessage({error: String(error)});
  }
};
