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
