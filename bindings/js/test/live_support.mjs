// What tests of live light in pages share: a room whose states are known, and pages that follow a server.
import assert from 'node:assert/strict';
import {createHash} from 'node:crypto';
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';

import {program} from './support.mjs';

export const FRAMES = 24, FPS = 25;

export const digest = (bytes) => createHash('sha256').update(bytes).digest('hex').slice(0, 16);

/** Makes room.gic in a folder: its frames by "COLOUR VISIBILITY", digests of both. */
export function makeRoom(folder) {
  const run = (name, ...values) => execFileSync(program(name), [...values, '-q'], {cwd: folder, stdio: 'pipe'});
  run('gi-trace', '--scene', 'tomb', '--grid', '8x4x8', '--frames', `${FRAMES}`, '--fps', `${FPS}`, '-o', 'room.gic');
  run('gicodec', 'decode', 'room.gic', '-o', 'out', '--files', 'raw');
  return new Map(Array.from({length: FRAMES}, (_, frame) => {
    const file = (name) => readFileSync(join(folder, `out/${name}.${String(frame).padStart(4, '0')}.raw`));
    return [`${digest(file('color'))} ${digest(file('vis'))}`, frame];
  }));
}

/** Opens webgl.html or webgpu.html of live_page.js. */
export async function openPage(browser, origin, name) {
  const page = await browser.newPage();
  await page.goto(`${origin}/${name}.html${name === 'webgpu' ? '?webgpu' : ''}`);
  await page.waitForFunction('window.ready', {timeout: 60000});
  assert.equal(await page.evaluate('window.ready'), true);
  return page;
}
export const call = (page, method, ...values) => page.evaluate((m, v) => window.page[m](...v), method, values);
export const updates = (page, count) => page.waitForFunction((n) => window.page.seen().length >= n, {timeout: 60000}, count);

/** Updates from the first on after which a client has all blocks: the first ones come in parts. */
export function fromWhole(states, seen) {
  const first = seen.findIndex(({color, vis}) => states.has(`${color} ${vis}`));
  assert.ok(first >= 0 && first < seen.length / 2, `update ${first} is the first whole one`);
  return seen.slice(first);
}
