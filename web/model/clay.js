// The objects of the viewer: a model of clay, and the platform below it.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, Color, DirectionalLight, DoubleSide, LightProbe, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, ShaderMaterial,
} from '../three.js';
import {toLamp} from './light.js';

const clay = 0xd9d2c6;
const edgeColour = new Color(0x0e5a66);
const filledColour = new Color(0xd9913f);
const sectionColours = [new Color(0xc8643c), new Color(0xf2c9a8)];
export const ringStep = 50;   // millimetres between the platform's rings
export const uncut = [0, 0, 1, 1e9];  // a plane above every model

/**
 * GLSL: discards what lies beyond the plane `cut`. A ray that meets the inner side of a closed surface has entered the
 * solid through the plane. There the section is seen, to which `place` is moved.
 */
export const cutShader = `uniform vec4 cut;
bool isSection(inout vec3 place) {
  float beyond = dot(place, cut.xyz) - cut.w;
  if (beyond > 0.0) discard;
  float eye = dot(cameraPosition, cut.xyz) - cut.w;
  if (gl_FrontFacing || eye <= 0.0) return false;
  place = mix(cameraPosition, place, eye / (eye - beyond));
  return true;
}`;

/**
 * Clay that can show its triangles, shaded flat where the geometry has no normals. It is matt, which a phone draws faster
 * than glossy clay. Each triangle has three vertices of its own, in order, so a vertex's index gives its corner. A pixel's
 * distance to the nearest edge comes from interpolated barycentric coordinates, without further buffers.
 * @param {Object} shown
 * @param {{value: number}} shown.edges  opacity of the edges, 0 to 1
 * @param {{value: number}} shown.filled  opacity of the colour of filled-in surface, 0 to 1
 * @param {{value: number}} shown.painted  1: the corners' colours are shown; 0: clay
 * @param {{value: number[]}} shown.cut  plane beyond which the model is cut off
 * @param {{value: number}} shown.hatch  millimetres between the lines of the section
 * @param {{value: number}} shown.shaded  1: the lamp's shadow on the model is shown, which holds for its first pose alone
 * @param {boolean} shown.isSmooth  whether the geometry has normals and light
 */
export function clayMaterial({edges, filled, painted, cut, hatch, shaded, isSmooth}) {
  const material = new MeshLambertMaterial({color: clay, flatShading: !isSmooth, side: DoubleSide});
  material.defines = isSmooth ? {LIT: 1} : {};
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {
      edgeStrength: edges, edgeColour: {value: edgeColour}, painted, cut, hatch, shaded,
      filledStrength: filled, filledColour: {value: filledColour},
      sectionColour: {value: sectionColours[0]}, hatchColour: {value: sectionColours[1]},
    });
    shader.vertexShader = `attribute float filled;
attribute vec3 paint;
attribute vec2 light;
varying vec2 vLight;
varying vec3 vPaint;
varying float vFilled;
varying vec3 vCorner;
varying vec3 vPlace;
${shader.vertexShader}`
        .replace('void main() {', `void main() {
      vFilled = filled;
      vPaint = paint;
      vLight = light;
      vPlace = (modelMatrix * vec4(position, 1.0)).xyz;
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
varying vec3 vPlace;
varying vec2 vLight;
uniform float shaded;
uniform float hatch;
uniform vec3 sectionColour;
uniform vec3 hatchColour;
${cutShader}
${shader.fragmentShader}`
        .replace('#include <color_fragment>', `#include <color_fragment>
      vec3 place = vPlace;
      bool isCut = isSection(place);
      diffuseColor.rgb = mix(diffuseColor.rgb, pow(vPaint, vec3(2.2)), painted);
      diffuseColor.rgb = mix(diffuseColor.rgb, filledColour, vFilled * filledStrength);`)
        .replace('#include <aomap_fragment>', `
      #ifdef LIT
      reflectedLight.indirectDiffuse *= vLight.x * vLight.x * 0.85 + 0.15;
      reflectedLight.directDiffuse *= mix(1.0, vLight.y, shaded);
      #endif
      reflectedLight.indirectDiffuse *= 0.8 + 0.35 * max(normal.z, 0.0);`)
        .replace('#include <opaque_fragment>', `
      vec3 perPixel = fwidth(vCorner);
      vec3 inside = smoothstep(perPixel * 0.4, perPixel * 1.4, vCorner);
      float edge = 1.0 - min(min(inside.x, inside.y), inside.z);
      float widest = max(max(perPixel.x, perPixel.y), perPixel.z);
      outgoingLight = mix(outgoingLight, edgeColour, edge * edgeStrength * (1.0 - smoothstep(0.5, 1.0, widest)));
      float line = dot(place, vec3(1.0)) / hatch;
      float soft = clamp((abs(fract(line) - 0.5) - 0.36) / fwidth(line) + 0.5, 0.0, 1.0);
      if (isCut) outgoingLight = mix(sectionColour, hatchColour, soft);
      #include <opaque_fragment>`);
  };
  return material;
}

/** The room's light: from above more than from below, a little more from the lamp's side, cool where it is dim. */
export function roomLight() {
  const probe = new LightProbe();
  const [all, y, z, x] = probe.sh.coefficients;
  all.set(1.1, 1.17, 1.26);
  z.set(0.58, 0.57, 0.55);
  x.set(0.12, 0.15, 0.19);
  y.set(0.2, 0.22, 0.25);
  return probe;
}

/** The lamp, which casts the shadow. */
export function lampLight() {
  const lamp = new DirectionalLight(0xfff0dd, 2.2);
  lamp.position.fromArray(toLamp);
  return lamp;
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

/**
 * The platform: a floor that fades into the dark, with rings and the model's shadow.
 * @param {number} radius  of its rings, millimetres @param {any} shadow  texture over a square of twice its half side
 * @param {number} halfSide  millimetres
 */
export function platform(radius, shadow, halfSide) {
  const lines = new BufferGeometry();
  lines.setAttribute('position', new BufferAttribute(new Float32Array(platformLines(radius)), 3));
  const grid = new LineSegments(lines,
      new LineBasicMaterial({color: 0xa9c6cc, transparent: true, opacity: 0.2, depthWrite: false}));
  const floor = new Mesh(new CircleGeometry(2.2 * radius, 96), new ShaderMaterial({
    transparent: true, depthWrite: false, side: DoubleSide,
    uniforms: {shadow: {value: shadow}, halfSide: {value: halfSide}, radius: {value: radius}},
    vertexShader: `varying vec2 vPlace;
void main() {
  vPlace = position.xy;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`,
    fragmentShader: `varying vec2 vPlace;
uniform sampler2D shadow;
uniform float halfSide;
uniform float radius;
void main() {
  float dark = texture2D(shadow, 0.5 + 0.5 * vPlace / halfSide).r;
  float far = length(vPlace) / radius;
  float lit = exp(-1.1 * far * far);
  vec3 colour = mix(vec3(0.36, 0.43, 0.47), vec3(0.02, 0.035, 0.045), 0.72 * dark);
  gl_FragColor = vec4(colour, (gl_FrontFacing ? 0.92 : 0.1) * lit);
}`,
  }));
  floor.renderOrder = -1;
  grid.position.z = -radius / 2000;  // below the model's lowest side, through which its section is drawn
  grid.add(floor);
  return grid;
}
