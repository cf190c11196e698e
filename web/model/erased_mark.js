// Marks the balls that will be erased from a model.

import {Group, Mesh, MeshBasicMaterial, SphereGeometry} from '../three.js';

const colour = 0xff6a4d;

/** @param {number[][]} balls_mm  centre and radius, in the model's frame */
export function erasedMark(balls_mm) {
  const mark = new Group();
  for (const [x, y, z, radius] of balls_mm) {
    const ball = new Mesh(new SphereGeometry(radius, 32, 16),
        new MeshBasicMaterial({color: colour, transparent: true, opacity: 0.45}));
    ball.position.set(x, y, z);
    mark.add(ball);
  }
  return mark;
}
