// Works around a deadlock of QEMU 7.2 with -icount.

import {readFileSync} from 'node:fs';

const interval = 1000;  // ms
const signalNumber = 29n;  // SIGIO's, on Linux

/** Whether QEMU blocks the signal to handle it as an event. Before that, the signal would kill it. */
function takesSignal(pid) {
  try {
    const [, blocked] = /^SigBlk:\s*([0-9a-f]+)$/m.exec(readFileSync(`/proc/${pid}/status`, 'latin1'));
    return (BigInt(`0x${blocked}`) >> (signalNumber - 1n) & 1n) === 1n;
  } catch {
    return false;  // QEMU has ended
  }
}

/**
 * Wakes QEMU's main loop once a second as long as it runs. An emulated processor that waits for a timer is woken by the main loop. On a
 * busy machine the loop sometimes falls asleep before it learns of that timer, and both sleep for ever; any event makes it check timers.
 * @param {import('node:child_process').ChildProcess} qemu
 */
export function wakeUp(qemu) {
  const timer = setInterval(() => takesSignal(qemu.pid) && qemu.kill('SIGIO'), interval);
  qemu.once('exit', () => clearInterval(timer));
}
