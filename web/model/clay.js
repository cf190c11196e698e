// The objects of the viewer: a model of clay, and the platform below it.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, Color, DirectionalLight, DoubleSide, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  MeshStandardMaterial,
} from '../three.js';

const clay = 0xd8d2c4;
const edgeColour = new Color(0x0e5a66);
const filledColour = new Color(0xd9913f);
export const ringStep = 50;   // millimetres between the platform's rings

/**
 * Clay that can show its triangles, shaded flat where the geometry has no normals. Each triangle has three vertices of its own, in order, so a vertex's index gives its
 * corner. A pixel's distance to the nearest edge comes from interpolated barycentric coordinates, without further buffers.
 * @param {Object} shown
 * @param {{value: number}} shown.edges  opacity of the edges, 0 to 1
 * @param {{value: number}} shown.filled  opacity of the colour of filled-in surface, 0 to 1
 * @param {{value: number}} shown.painted  1: the corners' colours are shown; 0: clay
 * @param {{value: number}} shown.top  millimetres; higher parts are cut off
 * @param {boolean} shown.isSmooth  whether the geometry has normals
 */
export function clayMaterial({edges, filled, painted, top, isSmooth}) {
  const material = new MeshStandardMaterial({color: clay, roughness: 0.78, metalness: 0, flatShading: !isSmooth, side: DoubleSide});
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {
      edgeStrength: edges, edgeColour: {value: edgeColour}, filledStrength: filled, filledColour: {value: filledColour}, painted, top,
    });
    shader.vertexShader = `attribute float filled;\nattribute vec3 paint;\nvarying vec3 vPaint;\nvarying float vFilled;\nvarying vec3 vCorner;\nvarying float vHeight;\n${shader.vertexShader}`
        .replace('void main() {', `void main() {
      vFilled = filled;
      vPaint = paint;
      vHeight = (modelMatrix * vec4(position, 1.0)).z;
      int corner = gl_VertexID % 3;
      vCorner = vec3(corner == 0, corner == 1, corner == 2);`);
    shader.fragmentShader = `varying vec3 vCorner;
varying float vFilled;
varying vec3 vPaint;
uniform float painted;
uniform float edgeStrength;
uniform vec3 edgeColour;
uniform float filledStrength;
uniform vec3 filledColour;
varying float vHeight;
uniform float top;
${shader.fragmentShader}`
        .replace('#include <color_fragment>', `#include <color_fragment>
      if (vHeight > top) discard;
      diffuseColor.rgb = mix(diffuseColor.rgb, pow(vPaint, vec3(2.2)), painted);
      diffuseColor.rgb = mix(diffuseColor.rgb, filledColour, vFilled * filledStrength);`)
        .replace('#include <opaque_fragment>', `
      vec3 perPixel = fwidth(vCorner);
      vec3 inside = smoothstep(perPixel * 0.4, perPixel * 1.4, vCorner);
      float edge = 1.0 - min(min(inside.x, inside.y), inside.z);
      float widest = max(max(perPixel.x, perPixel.y), perPixel.z);
      outgoingLight = mix(outgoingLight, edgeColour, edge * edgeStrength * (1.0 - smoothstep(0.5, 1.0, widest)));
      #include <opaque_fragment>`);
  };
  return material;
}

/** Lights that move with the camera, beside it, so that shapes are visible from every side. @param {any} camera */
export function lightsBeside(camera) {
  const key = new DirectionalLight(0xfff6e8, 2.1);
  key.position.set(-0.5, 0.8, 1);
  const rim = new DirectionalLight(0x7fe3dd, 1.1);
  rim.position.set(1, 0.35, -0.8);
  for (const light of [key, rim]) {
    light.target = camera;
    camera.add(light);
  }
}

/** @param {number} radius @returns {number[]} line segments of rings and two axes on the platform's surface */
function platformLines(radius) {
  const sides = 96;
  const lines = [-radius, 0, 0, radius, 0, 0, 0, -radius, 0, 0, radius, 0];
  for (let ring = ringStep; ring <= radius; ring += ringStep) {
    for (let i = 0; i < sides; ++i) {
      for (const at of [i, i + 1]) {
        const angle = 2 * Math.PI * at / sides;
        lines.push(ring * Math.cos(angle), ring * Math.sin(angle), 0);
      }
    }
  }
  return lines;
}

/** @param {number} radius  of the drawn platform, millimetres */
export function platform(radius) {
  const lines = new BufferGeometry();
  lines.setAttribute('position', new BufferAttribute(new Float32Array(platformLines(radius)), 3));
  const disc = new Mesh(new CircleGeometry(radius, 96),
      new MeshBasicMaterial({color: 0x5fb8b5, transparent: true, opacity: 0.07, depthWrite: false, side: 2}));
  const grid = new LineSegments(lines, new LineBasicMaterial({color: 0x7fc4c4, transparent: true, opacity: 0.28}));
  grid.add(disc);
  return grid;
}
