// Tells the end of a scan to somebody who does not look at the page: by a mark on its tab, and by a sound, if that is
// wanted.

import {element, part} from '../base/dom.js';
import {forget, note, noted} from '../base/storage.js';

const memory = 'octurn-sound';  // storage key
const tones_hz = [660, 880];
const tone_s = 0.5;
const betweenTones_s = 0.18;
const done = {mark: '✓', icon: 'icons/octurn-done.svg'};
const stopped = {mark: '!', icon: 'icons/octurn-stopped.svg'};
const usualIcon = 'icons/octurn.svg';

/** @type {typeof done | null} of a scan whose end nobody has seen */
let unseen = null;

const isTabIcon = 'link[rel=icon]';

/** @param {string} title @returns {string} as it stands on the tab */
export const marked = (title) => unseen ? `${unseen.mark} ${title}` : title;

function showIcon() {
  part(document, isTabIcon).setAttribute('href', unseen?.icon ?? usualIcon);
}

/** @type {AudioContext | null} */
let context = null;

function play() {
  const sounds = context ??= new AudioContext();
  sounds.resume();
  tones_hz.forEach((frequency, index) => {
    const [tone, volume] = [sounds.createOscillator(), sounds.createGain()];
    const start = sounds.currentTime + index * betweenTones_s;
    tone.frequency.value = frequency;
    volume.gain.setValueAtTime(0.2, start);
    volume.gain.exponentialRampToValueAtTime(0.001, start + tone_s);
    tone.connect(volume).connect(sounds.destination);
    tone.start(start);
    tone.stop(start + tone_s);
  });
}

/** @param {import('../api/api.js').Scan['state']} state  of the scan that no longer runs */
export function tellEnd(state) {
  if (state !== 'cancelled' && noted(memory)) {
    play();
  }
  if (document.hidden) {
    unseen = state === 'finished' ? done : stopped;
    showIcon();
  }
}

/** Attaches the handlers. */
export function prepareFinish() {
  const sound = element('sound');
  sound.checked = noted(memory) !== null;
  sound.addEventListener('change', () => {
    sound.checked ? note(memory) : forget(memory);
    sound.checked && play();  // as it will sound, and since a browser plays nothing before a click
  });
  document.addEventListener('visibilitychange', () => {
    if (unseen && !document.hidden) {
      document.title = document.title.replace(`${unseen.mark} `, '');
      unseen = null;
      showIcon();
    }
  });
}
