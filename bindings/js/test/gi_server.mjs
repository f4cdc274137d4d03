// gi-server for tests: in clear, on this machine alone.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {setTimeout} from 'node:timers/promises';

import {program} from './support.mjs';

/** Plays a file again and again: {child, address, said()}. `address`: where it listens, one that was free by itself. */
export async function giServer(file, {address = '127.0.0.1:0', options = []} = {}) {
  const folder = mkdtempSync(join(tmpdir(), 'gi-server-')), ports = join(folder, 'ports');
  const child = spawn(program('gi-server'), ['--play', file, '--loop', '--listen-web', address, '--insecure-web',
                                             '--port-file', ports, ...options], {stdio: ['ignore', 'ignore', 'pipe']});
  let text = '';
  child.stderr.on('data', (data) => { text += data; });
  try {
    for (const end = Date.now() + 30000; !existsSync(ports); await setTimeout(50)) {
      assert.ok(child.exitCode === null && Date.now() < end, `gi-server does not start: ${text}`);
    }
    return {child, address: `127.0.0.1:${readFileSync(ports, 'utf8').trim()}`, said: () => text};
  } finally {
    rmSync(folder, {recursive: true});
  }
}
