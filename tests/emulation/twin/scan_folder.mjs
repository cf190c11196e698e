// A simple writer of scan folders, version 1, with depth images in units of 0.1 mm. It shares no code with Octurn.

import {writeFileSync} from 'node:fs';

import {depthPng} from '../../support/depth_png.mjs';

const [width, height] = [640, 480];

/** @param {Buffer} depth  little-endian 16 bits, row by row @returns {Buffer} */
const png = (depth) => depthPng(width, height, (u, v) => depth.readUInt16LE(2 * (v * width + u)));

/** The nominal pose of the sensor: 0.62 m in front of the axis, 0.36 m above the platform, pitched down by 25 degrees. */
const [sine, cosine] = [Math.sin(25 * Math.PI / 180), Math.cos(25 * Math.PI / 180)];
const pose = [[1, 0, 0, 0], [0, -sine, cosine, -0.62], [0, -cosine, -sine, 0.36], [0, 0, 0, 1]];

/** @param {string} folder  must contain a folder snapshots @param {Buffer[]} depths  of a turn of evenly spaced stops */
export function writeScanFolder(folder, depths) {
  const files = depths.map((_, i) => `snapshots/${String(i).padStart(3, '0')}.png`);
  depths.forEach((depth, i) => writeFileSync(`${folder}/${files[i]}`, png(depth)));
  writeFileSync(`${folder}/scan.json`, JSON.stringify({
    format: 'octurn-scan', version: 1,
    sensor: {name: 'Kinect v1', width, height, fx: 575.8, fy: 575.8, cx: 320, cy: 240, depth_unit_m: 0.0001},
    calibration: {platform_from_sensor: pose},
    clip_m: {min: [-0.14, -0.14, 0.005], max: [0.14, 0.14, 0.4]},
    snapshots: files.map((file, i) => ({file, angle_deg: 360 * i / depths.length})),
  }));
}
