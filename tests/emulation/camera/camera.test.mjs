// The camera driver on a machine emulated by QEMU. The guest's uvcvideo and libcamera see a USB camera whose pictures this test
// makes.

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {createInterface} from 'node:readline';
import {test} from 'node:test';

import {wakeUp} from '../wake_up.mjs';
import {mjpeg} from './mjpeg.mjs';
import {UvcCamera} from './uvc_camera.mjs';

const {OCTURN_CAMERA: results} = process.env;

// Like most USB cameras: uncompressed, only small pictures have a good frame rate; large ones exist only compressed.
const lens = {formats: [
  {kind: 'mjpeg', sizes: [
    {width: 800, height: 600, picturesPerSecond: 15}, {width: 512, height: 384, picturesPerSecond: 15}, {width: 400, height: 304, picturesPerSecond: 15}]},
  {kind: 'yuy2', sizes: [{width: 400, height: 304, picturesPerSecond: 15}, {width: 512, height: 384, picturesPerSecond: 5}]},
]};

/** The modes in which pictures were requested. */
const modes = new Set();

/** A picture that identifies its number, by pixels, or by blocks if it is compressed. @param {boolean} isCut  whether it is truncated */
function picture(number, mode, isCut) {
  const {width, height, kind} = mode;
  modes.add(`${kind} ${width}`);
  if (kind === 'mjpeg') {
    const jpeg = mjpeg(mode, (x, y) => number + x + 2 * y & 0xff);
    return isCut ? jpeg.subarray(0, jpeg.length / 2) : jpeg;
  }
  const grey = new Uint8Array(width * height);
  for (let y = 0, at = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x, ++at) {
      grey[at] = number + x + 2 * y;
    }
  }
  return grey;
}

/** Runs the machine to its end. @param {(line: string) => void} hear  called with each line of its check @returns {Promise<string[]>} all lines */
async function run(camera, hear) {
  // The guest's clock counts its instructions (-icount): on a busy machine it slows down with the guest, so no picture is late.
  const machine = spawn('qemu-system-x86_64', [
    '-accel', 'tcg', '-icount', 'shift=3', '-m', '512', '-nodefaults', '-display', 'none', '-monitor', 'none', '-serial', 'stdio', '-no-reboot',
    '-kernel', `${results}/kernel`, '-initrd', `${results}/initrd`, '-append', 'console=ttyS0 loglevel=3 panic=-1',
    '-device', 'usb-ehci', ...camera.options], {stdio: ['ignore', 'pipe', 'inherit']});
  wakeUp(machine);
  const said = [];
  createInterface({input: machine.stdout}).on('line', (line) => {
    const [, text] = /check: (.*?)\r?$/.exec(line) ?? [];
    if (text !== undefined) {
      said.push(text);
      hear(text);
    } else {
      console.log(line);
    }
  });
  await once(machine, 'close');
  return said;
}

test('pictures come through USB, uvcvideo and libcamera, and what goes wrong is told', async () => {
  let isCut = false;
  const camera = await UvcCamera.listen(lens, (number, mode) => picture(number, mode, isCut));
  const said = await run(camera, (text) => {
    const isOver = text.startsWith('error') || text.startsWith('camera');
    camera.isSilent = text === 'be silent' || (camera.isSilent && !isOver);
    camera.isDamaged = text === 'be damaged' || (camera.isDamaged && !isOver);
    isCut = text === 'be cut' || (isCut && !isOver);
    if (text === 'unplug') {
      camera.unplug();
    }
  });
  await camera.close();

  const [size, ...rest] = said;
  assert.match(size, /^error sensor-other: Camera of a test: it makes no pictures of 640 x 616 .*it has 800 x 600, 512 x 384, 400 x 304\./);
  for (const [what, error, shown] of [
    ['be silent', 'sensor-silent', '400 x 304'], ['be damaged', 'sensor-silent', '400 x 304'], ['be cut', 'sensor-silent', '800 x 600'],
    ['be silent', 'sensor-silent', '512 x 384'], ['unplug', 'sensor-lost', '400 x 304'],
  ]) {
    assert.match(rest.shift(), /^camera Camera of a test, serial .*1d6b:0102$/);
    const told = new RegExp(`^picture (\\d+) of ${shown}, 0 pixels wrong, begun in order$`);
    const pictures = rest.splice(0, 8).map((text) => Number(told.exec(text)?.[1] ?? NaN));
    assert.ok(pictures.every((number, i) => i === 0 || number > pictures[i - 1]), said.join('\n'));
    assert.equal(rest.shift(), what);
    assert.match(rest.shift(), new RegExp(`^error ${error}: camera: Camera of a test .*`));
  }
  assert.deepEqual(rest, ['ended well']);
  // Uncompressed where that is as fast, compressed where that is faster or the only choice.
  assert.deepEqual([...modes].sort(), ['mjpeg 512', 'mjpeg 800', 'yuy2 400']);
  // Manual exposure, 10 ms in units of 100 us, and libcamera's smallest gain, which is the default.
  assert.deepEqual([...camera.values].sort(), [['1 2', 1], ['1 4', 100], ['2 4', 64]]);
});
