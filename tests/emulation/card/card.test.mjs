// The card's initrd, started by QEMU like a Pi's firmware would: which system it boots, and how it rolls back an update.

import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {copyFile, open, readFile, writeFile} from 'node:fs/promises';
import {before, beforeEach, test} from 'node:test';

import {Guest, readCard} from '../../image/guest.mjs';

const folder = process.env.OCTURN_CARD;
const image = `${folder}/card.img`;
process.env.MTOOLS_SKIP_CHECK = '1';

async function onImage(work) {
  const file = await open(image, 'r+');
  try {
    return await work(file);
  } finally {
    await file.close();
  }
}
const read = (position, length) => onImage(async (file) => (await file.read({buffer: Buffer.alloc(length), position})).buffer);
const write = (position, bytes) => onImage((file) => file.write(bytes, 0, bytes.length, position));

/** The byte range of a partition, its end exclusive. @param {number} number  1 to 4 */
async function partition(number) {
  const entry = await read(446 + (number - 1) * 16, 16);
  const begin = entry.readUInt32LE(8) * 512;
  return {begin, end: begin + entry.readUInt32LE(12) * 512};
}

const setMark = (text) => write(512, Buffer.from(text.padEnd(512, '\0')));
const namedSlot = async () => (await readCard(folder, 'config.txt')).at('os_prefix='.length);
async function nameSlot(slot) {
  const text = await readCard(folder, 'config.txt');
  await writeFile(`${folder}/config.txt`, text.replace(/^os_prefix=./, `os_prefix=${slot}`));
  execFileSync('mcopy', ['-o', '-i', `${image}@@1M`, `${folder}/config.txt`, '::']);
}

const imagesSignature = 0x4f637475;
const signature = async () => (await read(440, 4)).readUInt32LE();
const signWith = (number) => write(440, Buffer.from(new Uint32Array([number]).buffer));
const hex = (number) => number.toString(16).padStart(8, '0');
const namedDisk = async (slot = 'a') => (await readCard(folder, `${slot}/cmdline.txt`)).slice('octurn.disk='.length).split(' ')[0];
async function nameDisk(name) {
  await writeFile(`${folder}/cmdline.txt`, `octurn.disk=${name} quiet panic=10 octurn.slot=a\n`);
  execFileSync('mcopy', ['-o', '-i', `${image}@@1M`, `${folder}/cmdline.txt`, '::a/']);
}

/** Switches the machine on. @param {string[]} [more]  options of QEMU
 * @returns {Promise<string>} its console output until it restarted */
async function start(more) {
  const guest = await Guest.start('virt', folder, undefined, more);
  try {
    await guest.restarts(120);
  } finally {
    await guest.cutPower();
  }
  return readFile(`${folder}/console.log`, 'utf8');
}

before(async () => {
  execFileSync(`${import.meta.dirname}/make`, [process.env.OCTURN_DEBIAN, folder], {stdio: 'inherit'});
  const first = await partition(2);
  const second = await partition(3);
  await write(second.begin, await read(first.begin, first.end - first.begin));
});

beforeEach(async () => {
  await setMark('');
  await nameSlot('a');
});

test('a new card starts its first system, and its last partition fills it', async () => {
  assert.match(await start(), /SYSTEM a of \/dev\/vda, id [0-9a-f]{32}, mark ''/);
  assert.equal((await partition(4)).end, 1 << 30);
});

test('a new card gets a disk signature of its own, which the next start looks for', async () => {
  await signWith(imagesSignature);
  await nameDisk('00000000');
  assert.match(await start(), /SYSTEM a/);
  const own = await signature();
  assert.notEqual(own, imagesSignature);
  assert.equal(await namedDisk(), hex(own));
  assert.match(await start(), /SYSTEM a/);
  assert.equal(await signature(), own);
  await signWith(imagesSignature);
  await nameDisk('00000000');
  await start();
  assert.notEqual(await signature(), own, 'two cards have the same signature');
});

test('a signature that is not named, as after a cut of power, or another one, as Windows writes, is named at the next start', async () => {
  for (const [named, mark] of [['00000000', ''], ['89abcdef', ''], ['89abcdef', 'kept=a 1.2.3\n']]) {
    await setMark(mark);
    await signWith(0x12345678);
    await nameDisk(named);
    assert.match(await start(), /SYSTEM a of \/dev\/vda/);
    assert.equal(await signature(), 0x12345678);
    assert.equal(await namedDisk(), '12345678');
  }
});

test('of two Octurn cards the named one starts, not the one that is found first', async () => {
  await signWith(0x12345678);
  await copyFile(image, `${folder}/second.img`);
  await signWith(imagesSignature);
  await nameDisk('12345678');
  const second = ['-drive', `if=none,id=second,format=raw,file=${folder}/second.img`, '-device', 'virtio-blk-pci,drive=second'];
  assert.match(await start(second), /SYSTEM a of \/dev\/vdb/);
  assert.equal(await signature(), imagesSignature);
});

test('a card that was updated keeps its signature, for which the system before looks', async () => {
  await signWith(imagesSignature);
  await nameDisk('00000000');
  await setMark('kept=a 1.2.3\n');
  assert.match(await start(), /SYSTEM a/);
  assert.equal(await signature(), imagesSignature);
});

test('an update is tried once, then the system before it is back', async () => {
  await setMark('try=b 1.2.3\n');
  await nameSlot('b');
  assert.match(await start(), /SYSTEM b .* mark 'tried=b 1\.2\.3'/);
  assert.equal(await namedSlot(), 'b');
  assert.doesNotMatch(await start(), /SYSTEM/);
  assert.equal(await namedSlot(), 'a');
  assert.match(await start(), /SYSTEM a .* mark 'tried=b 1\.2\.3'/);
});

test('an update that was kept starts again', async () => {
  await setMark('kept=b 1.2.3\n');
  await nameSlot('b');
  assert.match(await start(), /SYSTEM b .* mark 'kept=b 1\.2\.3'/);
  assert.equal(await namedSlot(), 'b');
});

test('an update whose root is damaged is undone', async () => {
  const {begin} = await partition(3);
  const root = await read(begin, 4096);
  await write(begin, Buffer.alloc(root.length));
  await setMark('try=b 1.2.3\n');
  await nameSlot('b');
  assert.doesNotMatch(await start(), /SYSTEM/);
  assert.equal(await namedSlot(), 'b');
  assert.doesNotMatch(await start(), /SYSTEM/);
  assert.equal(await namedSlot(), 'a');
  assert.match(await start(), /SYSTEM a/);
  await write(begin, root);
});

test('an update that lost power before config.txt named it leaves the system as it was', async () => {
  await setMark('try=b 1.2.3\n');
  assert.match(await start(), /SYSTEM a .* mark 'try=b 1\.2\.3'/);
  assert.equal(await namedSlot(), 'a');
});
