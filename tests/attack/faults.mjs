// The test's side of faults.cpp: selects the daemon's failing calls, and its time of day.

import {closeSync, ftruncateSync, openSync, readSync, writeSync} from 'node:fs';
import {constants} from 'node:os';
import {join} from 'node:path';

export const calls = {write: 1n, sync: 2n, rename: 4n, open: 8n, read: 16n, change: 32n};
export const writing = calls.write | calls.sync | calls.rename;
export const changing = writing | calls.change;
export const reading = calls.open | calls.change | calls.read;
const forever = 2n ** 60n;

export class Faults {
  /** @param {string} control  folder for the control file @param {string} folder  calls on its files can fail */
  constructor(control, folder) {
    this.file = join(control, 'faults');
    this.descriptor = openSync(this.file, 'w+');
    this.env = {LD_PRELOAD: process.env.OCTURN_FAULTS_LIBRARY, OCTURN_FAULTS: this.file, OCTURN_FAULTS_FOLDER: folder};
    ftruncateSync(this.descriptor, 64); // eight numbers of 0: nothing fails
  }

  /** Lets `count` calls of these kinds fail from now on, beginning with number `first`, counted from 1. */
  fail(kinds, error, {first = 1, count = forever} = {}) {
    this.lift();
    [BigInt(constants.errno[error]), BigInt(first), BigInt(count), 0n, 0n].forEach((number, i) => this.put(1 + i, number));
    this.put(0, kinds);
  }

  /** Ends all failures. */
  lift() {
    this.put(0, 0n);
  }

  /** Sets the offset of the daemon's time of day. */
  setClock(seconds) {
    this.put(6, BigInt(seconds));
  }

  /** Gives the folder a disk of its own. @param {number} bytes  its size; 0: the real one's */
  setDisk(bytes) {
    this.put(7, BigInt(bytes));
  }

  /** The number of calls of the selected kinds, and of those that failed. */
  counts() {
    const numbers = Buffer.alloc(16);
    readSync(this.descriptor, numbers, 0, 16, 32);
    return {seen: Number(numbers.readBigUInt64LE(0)), failed: Number(numbers.readBigUInt64LE(8))};
  }

  put(index, number) {
    const bytes = Buffer.alloc(8);
    bytes.writeBigInt64LE(number);
    writeSync(this.descriptor, bytes, 0, 8, index * 8);
  }

  close() {
    closeSync(this.descriptor);
  }
}
