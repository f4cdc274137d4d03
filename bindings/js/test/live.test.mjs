// The light of a server in Chromium, as it changes: each state is one of the server's, on the GPU too.
import assert from 'node:assert/strict';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';

import {CHROMIUM_WITH_GPU, launch, pageOf, serve} from './browser_support.mjs';
import {giServer} from './gi_server.mjs';
import {FPS, FRAMES, call, digest, fromWhole, makeRoom, openPage, updates} from './live_support.mjs';
import {bytes, randomWords} from './support.mjs';
import {VolumeEncoder, Writer, volumeOfLayout} from 'gicodec/encoder';

let browser, pages, folder, server, url, states;

const play = (file, {options = [], ...more} = {}) => giServer(join(folder, file), {
  ...more, options: ['--proofs', '--rate', `${FPS}`, '--allow-origin', '*', ...options]});

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-live-'));
  states = makeRoom(folder);
  server = await play('room.gic');
  url = `ws://${server.address}`;
  pages = await serve({'/webgl.html': pageOf('live_page'), '/webgpu.html': pageOf('live_page', true)});
  browser = await launch(CHROMIUM_WITH_GPU);
});
after(async () => {
  await browser?.close();
  await pages?.close();
  server?.child.kill();
  rmSync(folder, {recursive: true, force: true});
});

const open = (name) => openPage(browser, pages.origin, name);

for (const [name, options, count] of [['webgl', {}, 200], ['webgpu', {}, 60], ['webgl', {worker: false}, 60]]) {
  test(`${name} follows a server ${JSON.stringify(options)}`, async () => {
    const page = await open(name);
    await call(page, 'start', url, options);
    await updates(page, count);
    const seen = fromWhole(states, await call(page, 'seen'));
    for (const {color, vis, gpu} of seen) {
      assert.ok(states.has(`${color} ${vis}`), 'a state that the server never had');
      assert.equal(gpu, color);
    }
    assert.ok(new Set(seen.map(({color}) => color)).size > FRAMES / 2);
    const statistics = await call(page, 'statistics');
    assert.ok(statistics.bytes > 0 && statistics.blocks > 0 && statistics.decodeMs > 0, JSON.stringify(statistics));
    assert.ok(seen.some(({uploadedBytes}) => uploadedBytes > 0), 'no update went to the GPU in parts');
    await call(page, 'stop');
    await page.close();
  });
}

for (const [layout, type, names] of [
  ['three', 'LightProbeGrid', ['grid']], ['unity-apv', 'TextureVolume', ['L0_L1Rx', 'L2_0', 'Validity']],
  ['unreal-vlm', 'TextureVolume', ['SHCoefficients0', 'DirectionalLightShadowing']]]) {
  test(`it follows a server of layout ${layout}`, async () => {
    const words = randomWords(5);
    const volume = await volumeOfLayout(layout, [4, 4, 4]);
    const writer = await Writer.create({[layout]: volume});
    const encoder = await VolumeEncoder.create(volume);
    const textures = Object.fromEntries(encoder.textures.map(({name, ArrayType, textureBytes}) => [name, new ArrayType(textureBytes / ArrayType.BYTES_PER_ELEMENT)]));
    const known = new Set();
    for (let frame = 0; frame < 8; ++frame) {  // some texels change in each, halves stay finite
      for (const texels of Object.values(textures)) {
        for (let i = 0; i < 4; ++i) texels[words.next().value % texels.length] = words.next().value & 0x7B7B7B7B;
      }
      writer.add(frame, textures);
      known.add(names.map((name) => digest(bytes(textures[name]))).join());
    }
    writeFileSync(join(folder, `${layout}.gic`), writer.finish());
    const {child, address} = await play(`${layout}.gic`);
    for (const name of ['webgl', 'webgpu']) {
      const page = await open(name);
      await call(page, 'follow', `ws://${address}`, layout, names);
      await updates(page, 30);
      const all = await call(page, 'seen');
      const seen = all.slice(all.findIndex(({held}) => known.has(held?.join())));
      assert.ok(seen.length >= 10, JSON.stringify(all.slice(0, 3)));
      for (const {type: is, same, held} of seen) {
        assert.equal(is.replace(/WebGL$/, ''), type);
        assert.ok(same.every(Boolean), `${name}: ${names} on the GPU ${same}`);
        assert.ok(known.has(held.join()), 'a state that the server never had');
      }
      assert.ok(seen.some(({uploadedBytes}) => uploadedBytes > 0), 'no update went to the GPU in parts');
      await call(page, 'stop');
      await page.close();
    }
    child.kill();
  });
}

test('it comes back after a server that was killed, and after a context that was lost', async () => {
  const {child, address} = await play('room.gic');
  const page = await open('webgl');
  await call(page, 'start', `ws://${address}`);
  await updates(page, 40);
  child.kill('SIGKILL');
  await page.waitForFunction(() => window.page.events().some(({type}) => type === 'lost'));
  const {child: again} = await play('room.gic', {address});
  const before = (await call(page, 'seen')).length;
  await updates(page, before + 40);
  await call(page, 'lose');
  await updates(page, (await call(page, 'seen')).length + 5);
  const seen = await call(page, 'seen');
  const [first, then] = [fromWhole(states, seen.slice(0, before)), fromWhole(states, seen.slice(before))];
  for (const {color, vis} of [...first, ...then]) assert.ok(states.has(`${color} ${vis}`));
  for (const {color, gpu} of then.slice(-3)) assert.equal(gpu, color);
  const held = await call(page, 'textures');
  await call(page, 'stop');
  assert.equal(await call(page, 'textures'), held - 3);  // colour, visibility, activity
  again.kill();
  await page.close();
});

test('a wrong token is said', async () => {
  const {child, address} = await play('room.gic', {options: ['--token', 'a'.repeat(32)]});
  const page = await open('webgl');
  for (const [token, wanted] of [['b'.repeat(32), 'closed'], ['a'.repeat(32), 'connected']]) {
    await call(page, 'start', `ws://${address}`, {token});
    await page.waitForFunction((type) => window.page.events().some((one) => one.type === type), {}, wanted);
    if (wanted === 'closed') assert.match((await call(page, 'events')).at(-1).reason, /token|authoris|authent/i);
    await call(page, 'stop');
  }
  child.kill();
  await page.close();
});

test('a server that is not there is said', async () => {
  const page = await open('webgl');
  await call(page, 'start', 'ws://127.0.0.1:9');
  await page.waitForFunction(() => window.page.events().some(({type}) => type === 'lost'));
  const [first] = await call(page, 'events');
  assert.ok(first.wait > 0 && first.why.length > 0, JSON.stringify(first));
  await call(page, 'stop');
  assert.equal(await call(page, 'textures'), 0);
  await page.close();
});
