// The camera driver on Debian 13's libcamera, whose virtual camera shows this test's pictures.

import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {test} from 'node:test';

import {count, size} from './frame_size.mjs';

const {OCTURN_VIRTUAL: folder, OCTURN_DEBIAN: debian} = process.env;

test('pictures of libcamera\'s virtual camera come as they are, in grey and in colour', () => {
  const console = execFileSync('qemu-system-aarch64', [
    '-M', 'virt', '-cpu', 'cortex-a57', '-m', '512', '-nographic', '-no-reboot', '-monitor', 'none', '-serial', 'stdio', '-nic', 'none',
    '-icount', 'shift=2',  // the guest's clock slows down with this machine
    '-kernel', `${debian}/kernel`, '-initrd', `${folder}/initrd.gz`,
    '-append', 'console=ttyAMA0 panic=-1 rdinit=/init quiet loglevel=3'], {encoding: 'utf8', timeout: 3_000_000, stdio: ['ignore', 'pipe', 'inherit']});
  const said = [...console.matchAll(/check: (.*?)\r?$/gm)].map(([, text]) => text);
  const [opened, ...pictures] = said.slice(0, -1);
  assert.equal(said.at(-1), 'ended well', console);
  assert.match(opened, /^camera Virtual of a test, serial .*a virtual camera/, console);
  const told = new RegExp(`^picture (\\d+) of ${size.width} x ${size.height}, 0 pixels wrong, begun in order$`);
  const numbers = pictures.map((text) => Number(told.exec(text)?.[1] ?? NaN));
  assert.equal(numbers.length, 8, console);
  assert.ok(numbers.every((number) => number >= 0 && number < count), console);
  assert.ok(new Set(numbers).size > 1, console);
});
