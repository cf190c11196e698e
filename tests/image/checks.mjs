// Functions shared by the image's tests.

import {setTimeout as sleep} from 'node:timers/promises';

import {secondsSince} from './guest.mjs';

/** Timeout of a wait on `virt`, seconds, on a busy machine. */
export const patience = 600;

/** @throws {Error}  unless the condition holds */
export function require(condition, text) {
  if (!condition) {
    throw new Error(text);
  }
}

/** Polls until `ask` resolves to something truthy, and returns that. */
export async function until(what, ask, seconds = patience) {
  const begin = performance.now();
  for (;;) {
    const answer = await ask();
    if (answer) {
      return answer;
    }
    require(secondsSince(begin) < seconds, `${what}: not within ${seconds} s`);
    await sleep(500);
  }
}

/**
 * Runs a test with the guest that `guest()` returns, and always stops that guest, also when the test is killed. @param {string} name
 * of the test @param {() => import('./guest.mjs').Guest | undefined} guest @param {() => Promise<void>} work
 */
export async function runTest(name, guest, work) {
  for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) {
    process.once(signal, () => process.exit(1));
  }
  try {
    await work();
    console.log(`${name}: passed`);
  } catch (error) {
    console.error(`${name}: failed: ${error.message}`);
    const inside = 'systemctl --no-pager --plain list-jobs; systemctl --no-pager --plain --failed; ' +
      'journalctl -b --no-pager -p warning | tail -n 40; journalctl -b -u "octurn*" -u systemd-networkd --no-pager | tail -n 60';
    console.error(await guest()?.run(inside).catch(String));
    process.exitCode = 1;
  } finally {
    await guest()?.cutPower();
  }
}
