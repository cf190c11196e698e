// A simple writer of scan folders, version 1, with depth images in units of 0.1 mm. It shares no code with Octurn.

import {writeFileSync} from 'node:fs';
import {deflateSync} from 'node:zlib';

const [width, height] = [640, 480];

/** The CRC of PNG, annex D. @param {Buffer} bytes */
function crc(bytes) {
  let value = 0xffffffff;
  for (const byte of bytes) {
    value ^= byte;
    for (let bit = 0; bit < 8; ++bit) {
      value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
    }
  }
  return (value ^ 0xffffffff) >>> 0;
}

function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, 'latin1'), data]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(data.length);
  check.writeUInt32BE(crc(body));
  return Buffer.concat([length, body, check]);
}

/** @param {Buffer} depth  little-endian 16 bits, row by row @returns {Buffer} a PNG of 16-bit grey */
function png(depth) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([16, 0, 0, 0, 0], 8);
  const swapped = Buffer.from(depth).swap16();
  const rows = Array.from({length: height}, (_, v) =>
    Buffer.concat([Buffer.alloc(1), swapped.subarray(2 * width * v, 2 * width * (v + 1))]));
  return Buffer.concat([Buffer.from('89504e470d0a1a0a', 'hex'), chunk('IHDR', header),
    chunk('IDAT', deflateSync(Buffer.concat(rows))), chunk('IEND', Buffer.alloc(0))]);
}

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
