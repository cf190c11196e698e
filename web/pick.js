// Picks the point of a model under a pixel. The vertices exist in GPU memory only, so the GPU renders that one pixel twice: with the
// position as its colour, and with the facet's normal, both in the model's current pose.

import {DoubleSide, FloatType, ShaderMaterial, WebGLRenderTarget} from './three.js';

/** @typedef {{place: number[], normal: number[]}} Spot  millimetres; unit vector towards the camera */

const pixel = new WebGLRenderTarget(1, 1, {type: FloatType});
const asNumbers = new ShaderMaterial({
  side: DoubleSide,
  uniforms: {top: {value: 0}, isNormal: {value: false}},
  vertexShader: `varying vec3 vPlace;
void main() {
  vec4 place = modelMatrix * vec4(position, 1.0);
  vPlace = place.xyz;
  gl_Position = projectionMatrix * viewMatrix * place;
}`,
  fragmentShader: `varying vec3 vPlace;
uniform float top;
uniform bool isNormal;
void main() {
  if (vPlace.z > top) discard;
  vec3 normal = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  gl_FragColor = vec4(isNormal ? normal : vPlace, 1.0);
}`,
});

/** @param {import('three').WebGLRenderer} renderer @param {any} model @param {import('three').PerspectiveCamera} camera @param {boolean} isNormal */
function read(renderer, model, camera, isNormal) {
  asNumbers.uniforms.isNormal.value = isNormal;
  renderer.clear();
  renderer.render(model, camera);
  const numbers = new Float32Array(4);
  renderer.readRenderTargetPixels(pixel, 0, 0, 1, 1, numbers);
  return numbers[3] === 1 ? [...numbers.slice(0, 3)] : null;
}

/**
 * @param {import('three').WebGLRenderer} renderer @param {import('three').PerspectiveCamera} camera @param {any} model
 * @param {number} top  millimetres; higher parts are cut off
 * @param {number} x @param {number} y  of the canvas, CSS pixels
 * @returns {Spot | null} null if the pixel does not show the model
 */
export function spotAt(renderer, camera, model, top, x, y) {
  const {clientWidth, clientHeight} = renderer.domElement;
  const clay = model.material;
  asNumbers.uniforms.top.value = top;
  camera.setViewOffset(clientWidth, clientHeight, Math.floor(x), Math.floor(y), 1, 1);
  model.material = asNumbers;
  renderer.setRenderTarget(pixel);
  const place = read(renderer, model, camera, false);
  const normal = place && read(renderer, model, camera, true);
  renderer.setRenderTarget(null);
  model.material = clay;
  camera.clearViewOffset();
  return place && normal && {place, normal};
}
