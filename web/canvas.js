// What all 3D pictures do with their canvas.

/**
 * Makes a picture as large and as fine as its canvas is shown.
 * @param {import('three').WebGLRenderer} renderer
 * @param {import('three').PerspectiveCamera} camera
 * @param {HTMLCanvasElement} canvas
 * @returns {boolean} whether it is shown at all
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

const longestClick = 6;  // pixels that a pointer may move meanwhile

/** @param {HTMLCanvasElement} canvas @param {(x: number, y: number) => void} onPoint  where it was clicked and not dragged, CSS pixels */
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
