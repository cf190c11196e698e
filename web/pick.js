// Which place of a model is under a pixel. The model's points are in the GPU's memory alone, so the GPU is asked: it draws that one
// pixel, with the place in the model's frame for a colour.

import {DoubleSide, FloatType, ShaderMaterial, WebGLRenderTarget} from './three.js';

const pixel = new WebGLRenderTarget(1, 1, {type: FloatType});
const asPlaces = new ShaderMaterial({
  side: DoubleSide,
  uniforms: {top: {value: 0}},
  vertexShader: `varying vec3 vPlace;
void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`,
  fragmentShader: `varying vec3 vPlace;
uniform float top;
void main() {
  if (vPlace.z > top) discard;
  gl_FragColor = vec4(vPlace, 1.0);
}`,
});

/**
 * @param {import('three').WebGLRenderer} renderer @param {import('three').PerspectiveCamera} camera @param {any} model
 * @param {number} top  millimetres: what is higher is not there
 * @param {number} x @param {number} y  of the canvas, CSS pixels
 * @returns {number[] | null} millimetres; null beside the model
 */
export function placeAt(renderer, camera, model, top, x, y) {
  const {clientWidth, clientHeight} = renderer.domElement;
  const clay = model.material;
  asPlaces.uniforms.top.value = top;
  camera.setViewOffset(clientWidth, clientHeight, Math.floor(x), Math.floor(y), 1, 1);
  model.material = asPlaces;
  renderer.setRenderTarget(pixel);
  renderer.clear();
  renderer.render(model, camera);
  renderer.setRenderTarget(null);
  model.material = clay;
  camera.clearViewOffset();
  const place = new Float32Array(4);
  renderer.readRenderTargetPixels(pixel, 0, 0, 1, 1, place);
  return place[3] === 1 ? [...place.slice(0, 3)] : null;
}
