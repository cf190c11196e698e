// The depth picture in the page: its distances in words, its scale.

import {brightnessOf, colour, colourOf, decoded, faintest, far} from './depth_picture.js';
import {fixed, text} from '../base/texts.js';

/** @param {number | null} distance  metres @returns {string} for people */
export const distanceText = (distance) => distance === null ? text('stage.no-reading') :
  distance >= far - 0.01 ? text('stage.beyond', {distance: `${far} m`}) : `${fixed(100 * distance, distance < 1 ? 1 : 0)} cm`;

/**
 * Draws a depth picture in colour.
 * @param {HTMLCanvasElement} canvas @param {Blob} png @returns {Promise<Uint8Array>} brightness of each pixel
 */
export async function drawDepth(canvas, png) {
  const picture = await decoded(canvas, png);
  const brightness = brightnessOf(picture.data);
  colour(picture.data);
  /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d')).putImageData(picture, 0, 0);
  return brightness;
}

/** Draws the colour scale. @param {HTMLCanvasElement} canvas  one column for each shade */
export function drawScale(canvas) {
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  const picture = context.createImageData(canvas.width, 1);
  for (let x = 0; x < canvas.width; ++x) {
    picture.data.set([...colourOf(faintest + x), 255], 4 * x);
  }
  context.putImageData(picture, 0, 0);
}
