// Colours of the depth picture: from deep blue for far readings through teal to warm white for near ones. Without texts
// and DOM, as a worker needs it, too.

/** Colours at equal steps of brightness, far to near. */
const stops = [[13, 38, 66], [14, 82, 105], [28, 130, 130], [98, 182, 143], [196, 221, 150], [255, 244, 214]];
export const faintest = 24;  // brightness of the farthest reading (API.md); 0 is no reading

/** @param {number} brightness  0 to 255 @returns {number[]} red, green, blue */
export function colourOf(brightness) {
  const at = (Math.max(brightness, faintest) - faintest) / (255 - faintest) * (stops.length - 1);
  const index = Math.min(Math.floor(at), stops.length - 2);
  return stops[index].map((value, channel) => Math.round(value + (stops[index + 1][channel] - value) * (at - index)));
}

const table = Array.from({length: 256}, (_, brightness) => colourOf(brightness));

/**
 * Colours a grey picture in place. Pixels without a reading become transparent.
 * @param {Uint8ClampedArray} pixels  red, green, blue, alpha
 * @param {Uint8Array | null} [chosen]  1 for each pixel to colour; the others stay grey
 */
export function colour(pixels, chosen = null) {
  for (let i = 0; i < pixels.length; i += 4) {
    const brightness = pixels[i];
    if (brightness === 0) {
      pixels[i + 3] = 0;
    } else if (chosen && !chosen[i / 4]) {
      pixels[i] = pixels[i + 1] = pixels[i + 2] = 24 + 0.42 * brightness;
    } else {
      [pixels[i], pixels[i + 1], pixels[i + 2]] = table[brightness];
    }
  }
}

/** The far end of the picture's depth range, metres (API.md). */
export const far = 2;

/**
 * Brightness is linear in inverse depth between the ends of the picture's range (API.md).
 * @param {number} brightness  0 to 255 @param {number} [nearest]  metres, of the sensor
 * @returns {number | null} metres, at most the picture's range; null without a reading
 */
export function distanceOf(brightness, nearest = 0.5) {
  const share = (brightness - faintest) / (255 - faintest);
  return brightness === 0 ? null : 1 / (share * (1 / (0.9 * nearest) - 1 / far) + 1 / far);
}

/** @param {Uint8ClampedArray} pixels  of a grey picture: red, green, blue, alpha */
export function brightnessOf(pixels) {
  const brightness = new Uint8Array(pixels.length / 4);
  for (let index = 0; index < brightness.length; ++index) {
    brightness[index] = pixels[4 * index];
  }
  return brightness;
}

/**
 * Brightens a camera's grey picture in place: it is exposed for lasers, and dark. One pixel in a hundred becomes white,
 * but not by more than a factor of 24, as there would be nothing but noise.
 * @param {Uint8ClampedArray} pixels  red, green, blue, alpha
 */
export function brighten(pixels) {
  const levels = brightnessOf(pixels).sort();
  const factor = Math.min(255 / Math.max(levels[Math.floor(0.99 * levels.length)], 1), 24);
  for (let i = 0; i < pixels.length; i += 4) {
    pixels[i] = pixels[i + 1] = pixels[i + 2] = factor * pixels[i];
  }
}

/**
 * Decodes a picture on a canvas.
 * @param {HTMLCanvasElement} canvas  or an OffscreenCanvas @param {Blob} png
 * @returns {Promise<ImageData>} as large as the canvas
 */
export async function decoded(canvas, png) {
  const bitmap = await createImageBitmap(png);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d', {willReadFrequently: true}));
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
  bitmap.close();
  return context.getImageData(0, 0, canvas.width, canvas.height);
}
