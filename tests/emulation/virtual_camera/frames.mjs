// frames.mjs FOLDER: writes the virtual camera's pictures, each with different blocks.

import {mkdirSync, writeFileSync} from 'node:fs';

import {mjpeg} from '../camera/mjpeg.mjs';
import {count, size} from './frame_size.mjs';

const [, , folder] = process.argv;
mkdirSync(folder, {recursive: true});
for (let number = 0; number < count; ++number) {
  writeFileSync(`${folder}/${number}.jpg`, mjpeg(size, (x, y) => number + x + 2 * y & 0xff));
}
