// The loader and the client in Debian's Firefox, which draws by Mesa on a display of its own.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';

import {pageOf, serve, tool} from './browser_support.mjs';
import {giServer} from './gi_server.mjs';
import {program} from './support.mjs';

const FIREFOX = '/usr/bin/firefox-esr', DISPLAYS = '/usr/bin/Xvfb';
let browser, display, pages, folder;

/** A display without a screen: its process and its name. */
async function makeDisplay() {
  const child = spawn(DISPLAYS, ['-displayfd', '1', '-screen', '0', '1280x1024x24', '-nolisten', 'tcp'], {stdio: ['ignore', 'pipe', 'ignore']});
  const name = await new Promise((resolve, reject) => {
    child.stdout.once('data', (data) => resolve(`:${`${data}`.trim()}`));
    child.once('exit', () => reject(new Error('Xvfb does not start')));
  });
  return {child, name};
}

describe('firefox', {skip: existsSync(FIREFOX) && existsSync(DISPLAYS) ? false : 'there is no Firefox: script/bootstrap firefox'}, () => {
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'gicodec-firefox-'));
    pages = await serve({'/three.html': pageOf('three_page'), '/layouts.html': pageOf('layouts_page'), '/live.html': pageOf('live_page')});
    display = await makeDisplay();
    const {default: puppeteer} = await tool('puppeteer-core');
    browser = await puppeteer.launch({
      browser: 'firefox', executablePath: FIREFOX, headless: false,
      env: {...process.env, HOME: folder, DISPLAY: display.name, LIBGL_ALWAYS_SOFTWARE: '1', MOZ_CRASHREPORTER_DISABLE: '1'},
      extraPrefsFirefox: {'webgl.force-enabled': true, 'app.update.disabledForTesting': true, 'datareporting.policy.dataSubmissionEnabled': false},
    });
  });
  after(async () => {
    await browser?.close();
    display?.child.kill();
    await pages?.close();
    rmSync(folder, {recursive: true, force: true, maxRetries: 5});
  });

  const open = async (name) => {
    const page = await browser.newPage();
    await page.goto(`${pages.origin}/${name}.html`);
    await page.waitForFunction('window.ready', {timeout: 120000});
    assert.equal(await page.evaluate('window.ready'), true);
    return page;
  };
  const call = (page, method, ...values) => page.evaluate((m, v) => window.page[m](...v), method, values);

  test('a baked grid comes back bit for bit, and lights as before', async () => {
    const page = await open('three');
    const found = await call(page, 'roundTrip');
    assert.ok(found.nonzero > found.texels / 2, `${found.nonzero} of ${found.texels}`);
    assert.equal(found.texelsDiffer, 0);
    assert.equal(found.picturesDiffer, 0);
    assert.ok(found.darkDiffer > 1000, `${found.darkDiffer}`);
    pages.put('/grid.gic', Buffer.from(found.file, 'base64'));
    const {texels: [first]} = await call(page, 'follow', '/grid.gic', [], 1);
    assert.ok(first.length > 0);
    assert.equal(await call(page, 'leaks', '/grid.gic'), 0);
    await page.close();
  });

  test('a client follows a server', async () => {
    execFileSync(program('gi-trace'), ['--scene', 'tomb', '--grid', '8x4x8', '--frames', '12', '--fps', '12', '-q', '-o', 'room.gic'], {cwd: folder});
    const {child, address} = await giServer(join(folder, 'room.gic'), {options: ['--rate', '12', '--allow-origin', '*', '--proofs']});
    const page = await open('live');
    await call(page, 'start', `ws://${address}`);
    await page.waitForFunction(() => window.page.seen().length >= 40, {timeout: 120000});
    const seen = (await call(page, 'seen')).slice(-20);
    for (const {color, gpu} of seen) assert.equal(gpu, color);
    assert.ok(new Set(seen.map(({color}) => color)).size > 5);
    assert.ok(seen.some(({uploadedBytes}) => uploadedBytes > 0));
    assert.deepEqual((await call(page, 'events')).filter(({type}) => type === 'error'), []);
    await call(page, 'stop');
    child.kill();
    await page.close();
  });
});
