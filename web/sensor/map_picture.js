// The sensor map as a picture: amber where the sensor reads too near, blue where it reads too far.

/** @typedef {{columns: number, rows: number, errors: number[]}} MapPicture  steps of disparity, row by row */

const ends = {far: [47, 111, 222], none: [238, 240, 240], near: [226, 128, 32]};
const full = 2;  // steps of disparity at full colour; a Kinect's fixed error is 0.8, root mean square

/** @param {number} error  steps of disparity; more is nearer @returns {number[]} red, green, blue */
export function errorColour(error) {
  const share = Math.min(1, Math.abs(error) / full);
  const end = error > 0 ? ends.near : ends.far;
  return ends.none.map((value, channel) => Math.round(value + share * (end[channel] - value)));
}

/** @param {HTMLCanvasElement} canvas @param {MapPicture} picture */
export function drawMap(canvas, {columns, rows, errors}) {
  canvas.width = columns;
  canvas.height = rows;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  const image = context.createImageData(columns, rows);
  errors.forEach((error, at) => image.data.set([...errorColour(error), 255], 4 * at));
  context.putImageData(image, 0, 0);
}
