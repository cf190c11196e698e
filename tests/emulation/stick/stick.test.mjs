// Models are copied to USB sticks with FAT and exFAT by Debian 13's kernel: that of the machine that runs the tests may
// know neither.

import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {test} from 'node:test';

const {OCTURN_STICK: folder, OCTURN_DEBIAN: debian} = process.env;
const drive = (type) => [
  '-drive', `if=none,id=${type},format=raw,file=${folder}/${type}.img`, '-device', `virtio-blk-pci,drive=${type}`];

test('models with all kinds of names are copied to FAT and exFAT, once and whole, and none is left in part on a full stick', () => {
  const console = execFileSync('qemu-system-aarch64', [
    '-M', 'virt', '-cpu', 'cortex-a57', '-m', '512', '-nographic', '-no-reboot', '-monitor', 'none',
    '-serial', 'stdio', '-nic', 'none',
    ...drive('vfat'), ...drive('exfat'), '-kernel', `${debian}/kernel`, '-initrd', `${folder}/initrd.gz`,
    '-append', 'console=ttyAMA0 panic=-1 rdinit=/init quiet loglevel=3'],
  {encoding: 'utf8', timeout: 1_200_000, stdio: ['ignore', 'pipe', 'inherit']});
  assert.match(console, /^FINISHED\r?$/m, console);
  for (const type of ['vfat', 'exfat']) {
    const said = [...console.matchAll(new RegExp(`^${type}: (.*?)\\r?$`, 'gm'))].map(([, text]) => text);
    assert.equal(said[0], 'copied 6 models to a USB stick', console);
    assert.equal(said[1], '6 models are whole, of 6 files', console);  // the second time, none was copied
    const full = said.findIndex((line) => line.endsWith('it may be full'));
    assert.ok(full > 1, console);
    assert.equal(said[full + 1], '6 models are whole, of 6 files', console);
    const readOnly = said.slice(full + 2);
    const refusal = 'a model could not be copied to the stick: it may be full';
    assert.ok(readOnly.some((line) => line.endsWith(refusal)), console);
  }
});
