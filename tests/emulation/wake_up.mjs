// Against a standstill of QEMU 7.2, where -icount counts its clock by instructions.

import {readFileSync} from 'node:fs';

const interval = 1000;  // ms
const signalNumber = 29n;  // SIGIO's, on Linux

/** Whether QEMU takes the signal for an event: before it does, the signal would end it. */
function takesSignal(pid) {
  try {
    const [, blocked] = /^SigBlk:\s*([0-9a-f]+)$/m.exec(readFileSync(`/proc/${pid}/status`, 'latin1'));
    return (BigInt(`0x${blocked}`) >> (signalNumber - 1n) & 1n) === 1n;
  } catch {
    return false;  // it has ended
  }
}

/**
 * Wakes QEMU up again and again, as long as it runs. A processor that waits for a timer is woken by QEMU's main loop, which on a busy
 * machine sometimes goes to sleep before it knows of that timer, and both sleep for ever. The loop looks for timers after any event.
 * @param {import('node:child_process').ChildProcess} qemu
 */
export function wakeUp(qemu) {
  const timer = setInterval(() => takesSignal(qemu.pid) && qemu.kill('SIGIO'), interval);
  qemu.once('exit', () => clearInterval(timer));
}
