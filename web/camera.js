// What the sensor sees now, refreshed for as long as it is looked at.

import * as api from './api.js';
import {drawDepth, drawScale} from './depth.js';
import {element, setText, show} from './dom.js';
import {sentence} from './format.js';

const betweenPictures = 250;   // milliseconds; the scanner may be busy with a scan
const betweenAttempts = 2000;  // while there is no picture

const isWatched = () => !document.hidden && !element('main').hidden && !element('camera').hidden && element('stage').dataset.reachable === 'yes';

async function showPicture() {
  try {
    await drawDepth(element('depth'), await api.preview());
    show(element('no-picture'), false);
    return betweenPictures;
  } catch (error) {
    const {detail, title, hint} = error instanceof api.Problem ? error : new api.Problem('picture', 'The picture cannot be read');
    setText(element('no-picture-text'), [detail || title, hint].map(sentence).join(' '));
    show(element('no-picture'), true);
    return betweenAttempts;
  }
}

/** Runs for as long as the page. */
export async function watchCamera() {
  drawScale(element('scale'));
  for (;;) {
    const pause = isWatched() ? await showPicture() : betweenPictures;
    await new Promise((done) => {
      setTimeout(done, pause);
    });
  }
}
