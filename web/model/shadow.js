// The soft shadow of a model on the platform, drawn once into a texture: the sum of the outlines that points of the lamp
// cast onto the platform.

import {
  AddEquation, CustomBlending, DoubleSide, LessDepth, LinearFilter, Mesh, OneFactor, OrthographicCamera, Scene,
  ShaderMaterial, WebGLRenderTarget,
} from '../three.js';
import {ofLamp} from './light.js';

const side = 512;          // pixels
const outlines = 24;
const fewOutlines = 8;     // of a mesh with many triangles
const manyTriangles = 100_000;

/**
 * Draws one outline. Its fragments have all the same depth, nearer than those of the outline before, so that each pixel
 * counts once for each outline, however many triangles cover it.
 */
const outline = new ShaderMaterial({
  side: DoubleSide, depthFunc: LessDepth,
  blending: CustomBlending, blendEquation: AddEquation, blendSrc: OneFactor, blendDst: OneFactor,
  uniforms: {lamp: {value: null}, reach: {value: 1}, depth: {value: 0}, share: {value: 1}},
  vertexShader: `uniform vec3 lamp;
uniform float reach;
uniform float depth;
void main() {
  vec3 place = (modelMatrix * vec4(position, 1.0)).xyz;
  vec2 fallen = place.xy - lamp.xy / lamp.z * max(place.z, 0.0);
  gl_Position = vec4(fallen / reach, depth, 1.0);
}`,
  fragmentShader: `uniform float share;
void main() {
  gl_FragColor = vec4(share);
}`,
});

export class Shadow {
  #target = new WebGLRenderTarget(side, side, {minFilter: LinearFilter, magFilter: LinearFilter});

  get texture() {
    return this.#target.texture;
  }

  /**
   * @param {any} renderer @param {any} model @param {any} pose  its matrix
   * @param {number} reach  millimetres from the axis to the texture's edges
   * @param {boolean} isBrief  whether the shadow is soon drawn again
   */
  draw(renderer, model, pose, reach, isBrief) {
    const count = isBrief || model.geometry.attributes.position.count > 3 * manyTriangles ? fewOutlines : outlines;
    const scene = new Scene();
    const cast = new Mesh(model.geometry, outline);
    cast.frustumCulled = false;
    cast.matrixAutoUpdate = false;
    cast.matrix.copy(pose);
    scene.add(cast);
    const camera = new OrthographicCamera();
    renderer.setRenderTarget(this.#target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.autoClear = false;
    ofLamp(count).forEach((lamp, i) => {
      Object.assign(outline.uniforms, {
        lamp: {value: lamp}, reach: {value: reach}, depth: {value: 0.9 - 1.8 * i / count}, share: {value: 1 / count},
      });
      outline.uniformsNeedUpdate = true;
      renderer.render(scene, camera);
    });
    renderer.autoClear = true;
    renderer.setRenderTarget(null);
  }
}
