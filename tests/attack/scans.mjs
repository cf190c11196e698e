// Multiplies scans by copying their folders under other names.

import {cpSync, linkSync, mkdirSync, readdirSync} from 'node:fs';
import {join} from 'node:path';

/** Copies a scan folder: small files are copied, large ones hard-linked. */
export function copyScan(from, to) {
  mkdirSync(join(to, 'snapshots'), {recursive: true});
  for (const entry of readdirSync(from, {withFileTypes: true, recursive: true})) {
    const path = join(entry.path, entry.name).slice(from.length);
    if (entry.isDirectory()) {
      mkdirSync(join(to, path), {recursive: true});
    } else if (/\.(png|stl)$/.test(path)) {
      linkSync(join(from, path), join(to, path));
    } else {
      cpSync(join(from, path), join(to, path));
    }
  }
}

/** The id of a scan taken `i` minutes after the start of 2020. */
export function idOf(i) {
  const time = new Date(Date.UTC(2020, 0, 1) + i * 60_000).toISOString().replace(/[-:]/g, '');
  return `${time.slice(0, 8)}-${time.slice(9, 15)}-${i.toString(16).padStart(4, '0').slice(-4)}`;
}
