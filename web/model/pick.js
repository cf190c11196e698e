// Picks the point of a model under a pixel. The vertices exist in GPU memory only, so the GPU renders that one pixel with the
// position as its colour, in the model's current pose.

import {DoubleSide, FloatType, ShaderMaterial, WebGLRenderTarget} from '../three.js';
import {cutShader} from './clay.js';

const pixel = new WebGLRenderTarget(1, 1, {type: FloatType});
const asPlaces = new ShaderMaterial({
  side: DoubleSide,
  uniforms: {cut: {value: [0, 0, 0, 0]}},
  vertexShader: `varying vec3 vPlace;
void main() {
  vec4 place = modelMatrix * vec4(position, 1.0);
  vPlace = place.xyz;
  gl_Position = projectionMatrix * viewMatrix * place;
}`,
  fragmentShader: `varying vec3 vPlace;
${cutShader}
void main() {
  vec3 place = vPlace;
  isSection(place);
  gl_FragColor = vec4(place, 1.0);
}`,
});

/**
 * @param {import('three').WebGLRenderer} renderer @param {import('three').PerspectiveCamera} camera @param {any} model
 * @param {number[]} cut  plane beyond which the model is cut off
 * @param {number} x @param {number} y  of the canvas, CSS pixels
 * @returns {number[] | null} millimetres; null if the pixel does not show the model
 */
export function placeAt(renderer, camera, model, cut, x, y) {
  const {clientWidth, clientHeight} = renderer.domElement;
  const clay = model.material;
  asPlaces.uniforms.cut.value = cut;
  camera.setViewOffset(clientWidth, clientHeight, Math.floor(x), Math.floor(y), 1, 1);
  model.material = asPlaces;
  renderer.setRenderTarget(pixel);
  renderer.clear();
  renderer.render(model, camera);
  const numbers = new Float32Array(4);
  renderer.readRenderTargetPixels(pixel, 0, 0, 1, 1, numbers);
  renderer.setRenderTarget(null);
  model.material = clay;
  camera.clearViewOffset();
  return numbers[3] === 1 ? [...numbers.slice(0, 3)] : null;
}
