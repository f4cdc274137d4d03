// A traced scene lit by its probes in Chromium, beside the picture of gi-render.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';

import {CHROMIUM_WITH_GPU, launch, pageOf, serve} from './browser_support.mjs';
import {program} from './support.mjs';
import {open} from 'gicodec';

const VIEW = {eye: [-3, 1.6, -8], target: [0, 1.4, -14], fov: 60, width: 160, height: 120};
let browser, server, folder;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-probes-'));
  const run = (name, ...values) => execFileSync(program(name), [...values, '-q'], {cwd: folder, stdio: 'pipe'});
  run('gi-trace', '--scene', 'villa', '--grid', '16x8x16', '--frames', '2', '--fps', '1', '-o', 'villa.gic');
  run('gi-trace', '--scene', 'villa', '--export-gltf', 'villa.glb');
  run('gi-render', '--stream', 'villa.gic', '--frame', '0', '--mode', 'gi', '--samples', '1', '--exposure', '1', '-o', 'villa.exr',
      `--size=${VIEW.width}x${VIEW.height}`, `--camera=${[...VIEW.eye, ...VIEW.target, VIEW.fov]}`);
  run('gicodec', 'decode', 'villa.gic', '-o', 'out', '--files', 'raw', '--frames', '0');
  const files = ['villa.gic', 'villa.glb', 'villa.exr'].map((name) => [`/${name}`, readFileSync(join(folder, name))]);
  server = await serve({...Object.fromEntries(files), '/webgl.html': pageOf('probes_page'), '/webgpu.html': pageOf('probes_page', true)});
  browser = await launch(CHROMIUM_WITH_GPU);
});
after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, {recursive: true, force: true});
});

/** Probes whose block of visibility is not zero: 18×18 texels of 4 bytes, 16·8 tiles a row. */
function active() {
  const file = readFileSync(join(folder, 'out/vis.0000.raw'));
  const words = new Uint32Array(file.buffer, file.byteOffset, file.length / 4);
  const found = new Set();
  words.forEach((word, i) => word !== 0 && found.add(Math.floor(i / (18 * 128) / 18) * 128 + Math.floor(i % (18 * 128) / 18)));
  return found.size;
}

for (const name of ['webgl', 'webgpu']) {
  test(`${name} shades as gi-render does`, async () => {
    const page = await browser.newPage();
    const said = [];
    page.on('console', (message) => ['error', 'warn'].includes(message.type()) && !message.text().includes('404') &&
      said.push(message.text()));  // there is no favicon.ico
    await page.goto(`${server.origin}/${name}.html${name === 'webgpu' ? '?webgpu' : ''}`);
    await page.waitForFunction('window.ready', {timeout: 60000});
    const found = await page.evaluate((view) => window.page.compare('/villa.gic', '/villa.glb', '/villa.exr', view), VIEW);
    ['color', 'vis'].forEach((texture, i) => assert.equal(
        found.texels[i], readFileSync(join(folder, `out/${texture}.0000.raw`)).toString('base64'), texture));
    assert.ok(found.kept > found.pixels / 3, `${found.kept} of ${found.pixels} pixels are away from silhouettes`);
    assert.ok(found.psnr >= 35, `${found.psnr} dB`);
    const {volumes: [{geometry}]} = await open(readFileSync(join(folder, 'villa.gic')));
    found.first.forEach((at, axis) => assert.ok(Math.abs(at - geometry.origin[axis]) < 1e-5));
    assert.ok(found.thrice > 2 * found.lit, `${found.thrice} ${found.lit}`);
    assert.equal(found.alone, 0);
    assert.equal(found.left, 0);
    assert.equal(found.shown, active());
    assert.ok(found.helperDiffers > 100 && found.ageDiffers > 100, `${found.helperDiffers} ${found.ageDiffers}`);
    assert.equal(found.unhelped, 0);
    assert.ok(found.lit > 0);
    assert.equal(found.dark, 0);
    assert.equal(found.hidden, 0);
    assert.equal(found.after, 0);
    assert.deepEqual(said, []);
    assert.deepEqual(found.states.map(({time}) => time), [0, 1]);
  });
}
