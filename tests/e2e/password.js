// A scanner whose page has a password.

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

/** A configuration that protects the page with this password. */
export async function configWith(t, password) {
  const folder = await mkdtemp(join(tmpdir(), 'octurn-password-'));
  t.after(() => rm(folder, {recursive: true}));
  const file = join(folder, 'password');
  const command = spawn(process.env.OCTURN_PROGRAM, ['password', file], {stdio: ['pipe', 'ignore', 'inherit']});
  command.stdin.end(`${password}\n`);
  assert.deepEqual(await once(command, 'exit'), [0, null]);
  await writeFile(join(folder, 'octurn.json'), JSON.stringify({password_file: file}));
  return join(folder, 'octurn.json');
}
