// Cuts power while a scan is being written, and checks the stored data after it.

import {setTimeout as sleep} from 'node:timers/promises';

import {Guest, readCard, secondsSince} from './guest.mjs';
import {requireKept} from './kept.mjs';

// Rewrites octurn.txt like octurn-wifi.service does after a password was entered, but in a loop and with unchanged content.
const writeSettings = `{ unshare --mount sh -ec '. /usr/lib/octurn/card.sh; cd /run/octurn-settings; cp octurn.txt written;
  while :; do write_card octurn.txt written; done' >/run/writing 2>&1 & }`.replace(/\s+/g, ' ');

/**
 * Runs a scan while settings are being written, until power fails at a random moment of the first 20 seconds.
 * @returns {Promise<{id: string, snapshots: number}>} the scan, and the snapshots that the daemon had reported as stored
 */
async function interruptedScan(guest, patience) {
  await guest.run(writeSettings);
  const {id} = await guest.startScan({snapshots: 60, frames: 1}, patience);
  const begin = performance.now();
  const end = Math.random() * 20;
  let snapshots = 0;
  while (secondsSince(begin) < end) {
    snapshots = (await guest.ask(`scans/${id}`)).snapshots_done;
    await sleep(Math.random() * 200);
  }
  await guest.cutPower();
  return {id, snapshots};
}

/**
 * @param {'virt' | 'raspi3b'} machine
 * @param {string} card
 * @param {number} cuts
 * @param {number} patience  seconds for a start
 * @param {(text: string) => void} say
 */
export async function cutPower(machine, card, cuts, patience, say) {
  const settings = await readCard(card, 'octurn.txt');
  const stored = [];
  let guest = await Guest.start(machine, card);
  try {
    await guest.page(patience);
    for (let cut = 1; cut <= cuts; ++cut) {
      stored.push(await interruptedScan(guest, patience));
      const left = await readCard(card, 'octurn.txt');
      if (left !== settings) {
        throw new Error(`octurn.txt is after a power cut\n${left}`);
      }
      guest = await Guest.start(machine, card);
      const seconds = await guest.page(patience);
      for (const {id, snapshots} of stored) {
        const scan = await guest.ask(`scans/${id}`);
        if (scan.state !== 'interrupted' || scan.snapshots_done < snapshots) {
          throw new Error(`${snapshots} snapshots were stored, and the scan is ${JSON.stringify(scan)}`);
        }
      }
      await requireKept(guest);
      const errors = await guest.run('journalctl -b -k -o cat | grep -iE "(EXT4-fs|FAT-fs|SQUASHFS|I/O).*error"');
      if (errors) {
        throw new Error(`file systems: ${errors}`);
      }
      say(`power cut ${cut} after ${stored.at(-1).snapshots} snapshots: all there, the page after ${seconds.toFixed(1)} s`);
    }
  } finally {
    await guest.cutPower();
  }
}
