// Light probe grids of three.js in Chromium, by WebGL and by WebGPU: baked, saved, loaded, their states.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';

import {CHROMIUM_WITH_GPU, launch, pageOf, serve, serveByNginx} from './browser_support.mjs';
import {bytes, golden, program, randomWords} from './support.mjs';

let browser, server;

before(async () => {
  server = await serve({
    '/webgl.html': pageOf('three_page'),
    '/webgpu.html': pageOf('three_page', true),
    '/text.gic': 'no container',
    '/newer.gic': golden('bad_major.gic'),
  });
  browser = await launch(CHROMIUM_WITH_GPU);
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const decode = (text) => new Uint8Array(Buffer.from(text, 'base64'));
const typed = (text, type) => new {Uint16Array, Float32Array}[type](decode(text).buffer);
const toNumber = (half) => {
  const sign = half & 0x8000 ? -1 : 1, exponent = (half >> 10) & 31, mantissa = half & 1023;
  return sign * (exponent === 0 ? mantissa * 2 ** -24 : (1024 + mantissa) * 2 ** (exponent - 25));
};

for (const [name, type] of [['webgl', 'Float32Array'], ['webgpu', 'Uint16Array']]) {
  describe(name, () => {
    let page, made;
    const call = (method, ...values) => page.evaluate((m, v) => window.page[m](...v), method, values);

    before(async () => {
      page = await browser.newPage();
      page.on('pageerror', (error) => assert.fail(error.message));
      await page.goto(`${server.origin}/${name}.html${name === 'webgpu' ? '?webgpu' : ''}`);
      await page.waitForFunction('window.ready', {timeout: 60000});
      assert.equal(await page.evaluate('window.ready'), true);
    });

    test('a baked grid comes back bit for bit, and lights as before', async () => {
      const found = await call('roundTrip');
      assert.equal(found.type, type);
      assert.equal(found.texels, 5 * 3 * 7 * (4 + 2) * 4);
      assert.ok(found.nonzero > found.texels / 2, `${found.nonzero} of ${found.texels}`);
      assert.equal(found.texelsDiffer, 0);
      assert.equal(found.picturesDiffer, 0);
      assert.ok(found.darkDiffer > 1000, `${found.darkDiffer}`);
      assert.deepEqual(found.box, found.bounds);
      assert.deepEqual(found.resolution, found.resolutionBefore);
      server.put(`/${name}.gic`, decode(found.file));
    });

    test('states are shown exactly, and between them blended', async () => {
      made = await call('states');
      server.put(`/${name}-states.gic`, decode(made.file));
      const found = await call('follow', `/${name}-states.gic`, ['noon', 6, 'lamp <b>off</b>', 12, 7.5, 99]);
      assert.deepEqual(found.states, [
        {frame: 0, time: 6, name: 'dawn'}, {frame: 1, time: 12, name: 'noon'}, {frame: 2, time: null, name: 'lamp <b>off</b>'}]);
      const [dawn, noon, off] = made.texels;
      assert.notEqual(dawn, noon);
      const [first, ...rest] = found.texels;
      assert.deepEqual([first, ...rest.slice(0, 4)], [dawn, noon, dawn, off, noon]);
      assert.equal(rest[5], noon);  // behind the last
      const [a, b, between] = [dawn, noon, rest[4]].map((text) => typed(text, type));
      const value = type === 'Uint16Array' ? toNumber : (one) => one;
      between.forEach((one, i) => {
        const wanted = value(a[i]) + (value(b[i]) - value(a[i])) * 0.25;
        assert.ok(Math.abs(value(one) - wanted) <= Math.abs(wanted) * 2 ** -10 + 2 ** -24, `${i}: ${value(one)}, not ${wanted}`);
      });
      const {events} = found;
      assert.equal(events.at(-1)[1], decode(made.file).length);
    });

    test('a grid that stays in the scene shows its states', async () => {
      assert.equal(await call('stays', `/${name}-states.gic`, 'noon'), made.texels[1]);
    });

    test('states that a file cannot hold are refused', async () => {
      assert.match(await call('refused', [{name: 'a\n1 2 b'}]), /a name in one line/);
      assert.match(await call('refused', [{time: '7'}]), /a finite time/);
    });

    test('workers decode the same', async () => {
      const found = await call('follow', `/${name}-states.gic`, ['noon'], 1);
      assert.deepEqual(found.texels, made.texels.slice(0, 2));
    });

    test('without parts of files all comes at once, and that is said', async () => {
      server.parts = false;
      const found = await call('follow', `/${name}-states.gic`, ['noon', 'lamp <b>off</b>']);
      server.parts = true;
      assert.deepEqual(found.texels, made.texels);
      const said = await page.evaluate('window.page.said');
      assert.equal(said.filter((line) => line.includes('sends no parts of files')).length, 1);
    });

    test('floats become half where that is asked for', {skip: type === 'Uint16Array'}, async () => {
      const halves = typed(await call('asHalf', '/webgl-states.gic'), 'Uint16Array');
      const floats = typed(made.texels[0], type);
      assert.equal(halves.length, floats.length);
      halves.forEach((half, i) => assert.ok(Math.abs(toNumber(half) - floats[i]) <= Math.abs(floats[i]) * 2 ** -10 + 2 ** -24));
    });

    test('what cannot be shown is said', async () => {
      const {Writer} = await import('gicodec/encoder');
      const components = [{name: 'age', type: 'uint', bits: 16, offset: 0}];
      const writer = await Writer.create({points: {kind: 'textures', textures: [
        {name: 'age', components, recordBytes: 2, grid: [2, 2, 1], block: [4, 4, 1], tiling: 'slices_xy_z'}]}});
      server.put('/points.gic', writer.finish());
      assert.match(await call('failure', '/points.gic'), /no texture that a GPU can have: it has volumes of kind textures/);
      assert.match(await call('failure', '/absent.gic'), /the server answers 404/);
      assert.match(await call('failure', '/text.gic'), /GicodecError: .*not/i);
      assert.match(await call('failure', '/newer.gic'), /the container has version 3\.0, and gicodec \d.* reads version 1: take a newer gicodec/);
      const cut = decode(made.file);
      server.put('/cut.gic', cut.subarray(0, cut.length - 40));
      assert.equal(await call('failure', '/cut.gic'), null);  // all states are there
      server.put('/cut.gic', cut.subarray(0, 300));
      assert.match(await call('failure', '/cut.gic'), /GicodecError|RangeError/);
      const damaged = cut.slice();
      damaged[damaged.length >> 1] ^= 1;
      server.put('/damaged.gic', damaged);
      const said = await call('follow', '/damaged.gic', ['noon', 'lamp <b>off</b>']).then(() => null, ({message}) => message);
      assert.match(said, /GicodecError|corrupt|checksum/i);
    });

    test('dumps that the command line packs are shown bit for bit', async () => {
      const folder = mkdtempSync(join(tmpdir(), 'gicodec-dumps-'));
      const words = randomWords(7);
      const texels = [0, 1].map(() => Uint16Array.from({length: 5 * 3 * 7 * (4 + 2) * 4}, () => words.next().value >>> 16));
      mkdirSync(join(folder, 'in'));
      texels.forEach((one, frame) => writeFileSync(join(folder, `in/grid.000${frame}.raw`), bytes(one)));
      const run = (...values) => execFileSync(program('gicodec'), values, {cwd: folder, stdio: 'pipe'});
      run('encode', '-q', '-o', 'x.gic', '--layout', 'three', '--grid', '5x3x4', '--bounds=-400,0,-300,400,400,300',
          '--unit', '0.01', '--state', '0=6:dawn', '--state', '1=18:dusk', 'in');
      run('decode', '-q', 'x.gic', '-o', 'out', '--files', 'raw');
      server.put('/dumps.gic', readFileSync(join(folder, 'x.gic')));
      const found = await call('follow', '/dumps.gic', ['dusk']);
      [0, 1].forEach((frame) => assert.equal(
          readFileSync(join(folder, `out/grid.000${frame}.raw`)).toString('base64'), found.texels[frame]));
      assert.deepEqual(found.box, [-4, 0, -3, 4, 4, 3]);
      rmSync(folder, {recursive: true});
    });

    test('nothing is left on the GPU', async () => {
      assert.equal(await call('leaks', `/${name}-states.gic`), 0);
    });
  });
}

test('what a file says of its place that cannot be is as if it said nothing', async () => {
  const {Writer, volumeOfLayout} = await import('gicodec/encoder');
  const volume = await volumeOfLayout('three', [2, 1, 1]);
  const page = await browser.newPage();
  await page.goto(`${server.origin}/webgl.html`);
  await page.waitForFunction('window.ready', {timeout: 60000});
  for (const [bounds, unit, wanted] of [
    ['0 0 0 0 1 1', '1', [-1, -0.5, -0.5, 1, 0.5, 0.5]], ['a b', '-1', [-1, -0.5, -0.5, 1, 0.5, 0.5]],
    ['0 0 0 1 1 1e999', '1', [-1, -0.5, -0.5, 1, 0.5, 0.5]], ['0 0 0 200 100 100', '0.01', [0, 0, 0, 2, 1, 1]],
    ['0 0 0 2 1 1', 'x', [0, 0, 0, 2, 1, 1]]]) {
    const metadata = {'gicodec:layout': 'three', 'gicodec:bounds': bounds, 'gicodec:unit': unit};
    const writer = await Writer.create({room: {...volume, metadata}});
    writer.add(0, {grid: new Uint16Array(2 * 7 * 3 * 4)});
    server.put('/place.gic', writer.finish());
    const {box} = await page.evaluate(() => window.page.follow('/place.gic', []));
    assert.deepEqual(box, wanted, `${bounds}, ${unit}`);
  }
  await page.close();
});

test('of a file with many states only what is shown is loaded, here from nginx', async (t) => {
  const {Writer, volumeOfLayout} = await import('gicodec/encoder');
  const grid = [32, 16, 16];
  const volume = await volumeOfLayout('three', grid);
  const writer = await Writer.create({room: {...volume, metadata: {'gicodec:layout': 'three', 'gicodec:bounds': '0 0 0 1 1 1'}}},
                                     {preset: 'turbo', gop: 1});
  const texels = new Uint16Array(grid[0] * grid[1] * 7 * (grid[2] + 2) * 4);
  for (let frame = 0; frame < 40; ++frame) {
    for (let i = 0; i < texels.length; ++i) texels[i] = Math.imul(i + frame * 7919, 2654435761) >>> 17;
    writer.add(frame, {grid: texels}, 'all');
  }
  const file = writer.finish();
  const wanted = Uint16Array.from(texels, (_, i) => Math.imul(i + 30 * 7919, 2654435761) >>> 17);
  const nginx = await serveByNginx({'many.gic': file, 'webgl.html': pageOf('three_page')});
  t.after(() => nginx.close());
  const page = await browser.newPage();
  await page.goto(`${nginx.origin}/webgl.html`);
  await page.waitForFunction('window.ready', {timeout: 60000});
  const found = await page.evaluate(() => window.page.follow('/many.gic', [30]));
  const before = nginx.log().length;
  assert.equal(found.texels[1], Buffer.from(bytes(wanted)).toString('base64'));
  assert.deepEqual(await page.evaluate(() => window.page.sources('/many.gic')), Array(5).fill(40));
  const asked = nginx.log().slice(0, before).filter(({path}) => path === '/many.gic');
  assert.ok(asked.every(({status}) => status === 206));
  const sent = asked.reduce((sum, {size}) => sum + size, 0);
  assert.ok(sent < 0.15 * file.length, `${sent} of ${file.length} bytes`);
  assert.ok(asked.length <= 8, `${asked.length} requests`);
});
