// Functions for the canvases of 3D pictures.

/**
 * Sets the renderer's size and resolution to those of its canvas.
 * @param {import('three').WebGLRenderer} renderer
 * @param {import('three').PerspectiveCamera} camera
 * @param {HTMLCanvasElement} canvas
 * @returns {boolean} whether the canvas is visible
 */
export function fitToCanvas(renderer, camera, canvas) {
  const {clientWidth: width, clientHeight: height} = canvas;
  if (width === 0 || height === 0) {
    return false;
  }
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  return true;
}

const longestClick = 6;  // pixels that a pointer may move during a click

/** @param {HTMLCanvasElement} canvas @param {(x: number, y: number) => void} onPoint  position of a click that is no drag, CSS pixels */
export function onClick(canvas, onPoint) {
  /** @type {number[] | null} */
  let down = null;
  canvas.addEventListener('pointerdown', ({offsetX, offsetY}) => {
    down = [offsetX, offsetY];
  });
  canvas.addEventListener('pointerup', ({offsetX, offsetY}) => {
    if (down && Math.hypot(offsetX - down[0], offsetY - down[1]) < longestClick) {
      onPoint(offsetX, offsetY);
    }
    down = null;
  });
}
