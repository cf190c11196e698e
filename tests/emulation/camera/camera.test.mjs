// The driver of cameras on a machine that QEMU emulates: its kernel's uvcvideo and its libcamera see a USB camera, whose pictures
// this test makes.

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {createInterface} from 'node:readline';
import {test} from 'node:test';

import {wakeUp} from '../wake_up.mjs';
import {UvcCamera} from './uvc_camera.mjs';

const {OCTURN_CAMERA: results} = process.env;
const lens = {width: 820, height: 616, picturesPerSecond: 15};

/** A picture that no other has, row by row. */
function picture(number) {
  const grey = new Uint8Array(lens.width * lens.height);
  for (let y = 0, at = 0; y < lens.height; ++y) {
    for (let x = 0; x < lens.width; ++x, ++at) {
      grey[at] = number + x + 2 * y;
    }
  }
  return grey;
}

/** Runs the machine to its end. @param {(line: string) => void} hear  what its check says @returns {Promise<string[]>} all of that */
async function run(camera, hear) {
  // Its clock counts what it computes: on a busy machine it is late with the pictures, and no picture is late.
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
  const camera = await UvcCamera.listen(lens, picture);
  const said = await run(camera, (text) => {
    camera.isSilent = text === 'be silent' || (camera.isSilent && !text.startsWith('error'));
    camera.isDamaged = text === 'be damaged' || (camera.isDamaged && !text.startsWith('error'));
    if (text === 'unplug') {
      camera.unplug();
    }
  });
  await camera.close();

  const [size, ...rest] = said;
  assert.match(size, /^error sensor-other: Camera of a test: it makes no pictures of 640 x 616 .*it has 820 x 616\./);
  for (const [what, error] of [['be silent', 'sensor-silent'], ['be damaged', 'sensor-silent'], ['unplug', 'sensor-lost']]) {
    assert.match(rest.shift(), /^camera Camera of a test, serial .*1d6b:0102$/);
    const pictures = rest.splice(0, 8).map((text) => Number(/^picture (\d+) of 820 x 616, 0 pixels wrong, begun in order$/.exec(text)?.[1] ?? NaN));
    assert.ok(pictures.every((number, i) => i === 0 || number > pictures[i - 1]), pictures.join(' '));
    assert.equal(rest.shift(), what);
    assert.match(rest.shift(), new RegExp(`^error ${error}: camera: Camera of a test .*`));
  }
  assert.deepEqual(rest, ['ended well']);
  // By hand, 10 ms in units of 100 us, and the least gain that libcamera knows: the default.
  assert.deepEqual([...camera.values].sort(), [['1 2', 1], ['1 4', 100], ['2 4', 64]]);
});
