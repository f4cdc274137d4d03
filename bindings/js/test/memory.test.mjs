// A page that follows a server for long: its memory, and that of Chromium's processes, stays as it was.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, readdirSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';

import {CHROMIUM_WITH_GPU, launch, pageOf, serve} from './browser_support.mjs';
import {giServer} from './gi_server.mjs';
import {program} from './support.mjs';

const WARM = 300, UPDATES = 1000;
let browser, pages, folder, server;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-memory-'));
  execFileSync(program('gi-trace'), ['--scene', 'tomb', '--grid', '8x4x8', '--frames', '24', '--fps', '24', '-q', '-o', 'room.gic'], {cwd: folder});
  server = await giServer(join(folder, 'room.gic'), {options: ['--rate', '60', '--allow-origin', '*']});
  pages = await serve({'/webgl.html': pageOf('live_page')});
  browser = await launch([...CHROMIUM_WITH_GPU, '--js-flags=--expose-gc']);
});
after(async () => {
  await browser?.close();
  await pages?.close();
  server?.child.kill();
  rmSync(folder, {recursive: true, force: true});
});

/** Private bytes of a process and of all below it. */
function privateBytes(root) {
  const parents = new Map();
  for (const name of readdirSync('/proc').filter((one) => /^\d+$/.test(one))) {
    try {
      const [, parent] = /^PPid:\s*(\d+)/m.exec(readFileSync(`/proc/${name}/status`, 'utf8'));
      parents.set(Number(name), Number(parent));
    } catch {}  // it has just ended
  }
  const below = (pid) => pid === root || (parents.has(pid) && below(parents.get(pid)));
  let sum = 0;
  for (const pid of parents.keys()) {
    if (!below(pid)) continue;
    try {
      for (const [, size] of readFileSync(`/proc/${pid}/smaps_rollup`, 'utf8').matchAll(/^Private_\w+:\s*(\d+) kB/gm)) sum += 1024 * Number(size);
    } catch {}
  }
  return sum;
}

test(`memory stays flat over ${UPDATES} updates`, async () => {
  const page = await browser.newPage();
  await page.goto(`${pages.origin}/webgl.html`);
  await page.waitForFunction('window.ready', {timeout: 60000});
  await page.evaluate(() => window.page.render());
  const own = await page.evaluate(() => window.page.textures());  // of three.js
  await page.evaluate((url) => window.page.draw(url), `ws://${server.address}`);
  const at = async (updates) => {
    await page.waitForFunction((n) => window.page.statistics().updates >= n, {timeout: 120000}, updates);
    await page.evaluate(() => { for (let i = 0; i < 4; ++i) globalThis.gc(); });
    const {JSHeapUsedSize: heap} = await page.metrics();
    return {heap, all: privateBytes(browser.process().pid), textures: await page.evaluate(() => window.page.textures())};
  };
  const before = await at(WARM);
  const after = await at(WARM + UPDATES);
  const said = JSON.stringify({before, after});
  assert.equal(after.textures, before.textures, said);
  assert.ok(after.heap < before.heap + (1 << 20), said);
  assert.ok(after.all < before.all + (24 << 20), said);
  await page.evaluate(() => window.page.stop());
  assert.equal(await page.evaluate(() => window.page.textures()), own);
  assert.ok(before.textures > own);
});
