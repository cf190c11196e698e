// Functions shared by the live depth pictures: the rig's lines, and the distance under the pointer.

import {distanceText} from './depth.js';
import {distanceOf} from './depth_picture.js';
import {part, setText, show} from '../base/dom.js';
import {overlayOf} from './overlay.js';

export const radius_mm = 150;  // of the platform

/** @param {SVGElement} overlay  over the whole picture @param {import('./live_picture.js').Rig} rig */
export function drawLines(overlay, {pose, sensor, clip_mm}) {
  const viewBox = `0 0 ${sensor.width} ${sensor.height}`;
  if (overlay.getAttribute('viewBox') !== viewBox) {
    overlay.setAttribute('viewBox', viewBox);
  }
  for (const [line, path] of Object.entries(overlayOf({pose, sensor, clip_mm, radius_mm}))) {
    const drawn = part(overlay, `[data-line=${line}]`);
    if (drawn.getAttribute('d') !== path) {  // a browser draws it again, with its shadow, even if nothing has changed
      drawn.setAttribute('d', path);
    }
  }
}

/**
 * Shows the distance at the pointer.
 * @param {HTMLElement} frame  around the picture @param {HTMLElement} label  inside the frame
 * @returns {(brightness: Uint8Array, sensor?: import('./overlay.js').Sensor) => void} to be called with each new picture
 */
export function prepareDistance(frame, label) {
  const canvas = part(frame, 'canvas');
  /** @type {Uint8Array | null} */
  let picture = null;
  /** @type {number | undefined} metres */
  let nearest;
  /** @type {[number, number] | null} pixel */
  let pointed = null;

  const render = () => {
    show(label, pointed !== null && picture !== null);
    if (pointed && picture) {
      const [x, y] = pointed;
      setText(label, distanceText(distanceOf(picture[y * canvas.width + x], nearest)));
    }
  };
  const point = (/** @type {PointerEvent} */ event) => {
    const bounds = canvas.getBoundingClientRect();
    const at = [(event.clientX - bounds.left) / bounds.width, (event.clientY - bounds.top) / bounds.height];
    pointed = at.some((share) => share < 0 || share >= 1) ? null : [Math.floor(at[0] * canvas.width), Math.floor(at[1] * canvas.height)];
    label.style.left = `${100 * at[0]}%`;
    label.style.top = `${100 * at[1]}%`;
    label.dataset.side = at[0] > 0.7 ? 'left' : 'right';
    render();
  };
  frame.addEventListener('pointermove', point);
  frame.addEventListener('pointerdown', point);
  frame.addEventListener('pointerleave', () => {
    pointed = null;
    render();
  });
  return (brightness, sensor) => {
    picture = brightness;
    nearest = sensor?.nearest_m;
    render();
  };
}
