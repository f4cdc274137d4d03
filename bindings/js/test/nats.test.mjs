// Light over NATS, through the WebSockets of nats-server: in Chromium, and without a page.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {setTimeout} from 'node:timers/promises';

import {wsconnect} from '@nats-io/nats-core';
import WebSocket from 'ws';

import {TrackReceiver, connectNats} from 'gicodec/client';

import {CHROMIUM_WITH_GPU, launch, pageOf, project, serve, tool} from './browser_support.mjs';
import {FPS, call, digest, fromWhole, makeRoom, openPage, updates} from './live_support.mjs';
import {natsServer} from './nats_server.mjs';
import {bytes, randomBytes} from './support.mjs';

let browser, pages, folder, nats, publisher, states;
const publish = (...options) => nats.publish(join(folder, 'room.gic'), ['--rate', `${FPS}`, '--region', '4x4x4', ...options]);

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-nats-room-'));
  states = makeRoom(folder);
  nats = await natsServer();
  publisher = await publish();
  const {build} = await tool('esbuild');
  const {outputFiles: [{text}]} = await build({
    stdin: {contents: "export {wsconnect} from '@nats-io/nats-core';", resolveDir: project}, bundle: true, write: false, format: 'esm'});
  pages = await serve({'/webgl.html': pageOf('live_page'), '/webgpu.html': pageOf('live_page', true), '/nats-core.js': text});
  browser = await launch([...CHROMIUM_WITH_GPU, '--ignore-certificate-errors']);
});
after(async () => {
  await browser?.close();
  await pages?.close();
  nats?.close();
  rmSync(folder, {recursive: true, force: true});
});

for (const [name, options] of [['webgl', {}], ['webgpu', {}], ['webgl', {worker: false}]]) {
  test(`${name} holds what is published ${JSON.stringify(options)}`, async () => {
    const page = await openPage(browser, pages.origin, name);
    await call(page, 'start', nats.options, options);
    await updates(page, 40);
    const seen = fromWhole(states, await call(page, 'seen'));
    for (const {color, vis, gpu} of seen) {
      assert.ok(states.has(`${color} ${vis}`), 'a state that was never published');
      assert.equal(gpu, color);
    }
    assert.ok(new Set(seen.map(({color}) => color)).size > 10);
    await call(page, 'stop');
    await page.close();
  });
}

/** A connection of Node's. */
const connectNode = (options = {}) => wsconnect({
  ...nats.options, reconnectTimeWait: 100, ...options,
  wsFactory: async (url) => ({socket: new WebSocket(url, {ca: readFileSync(nats.ca)}), encrypted: true})});

/** Follows until `count` updates have come: what each left in the client. */
async function follow(connection, options, count, onUpdate = () => {}) {
  const seen = [];
  const made = await new Promise((resolve, reject) => {
    const opening = connectNats(connection, {...options, onUpdate(client) {
      const [room] = client.volumes;
      seen.push({color: digest(bytes(room.texels('color'))), vis: digest(bytes(room.texels('vis'))), epoch: client.state.epoch});
      onUpdate(client);
      if (seen.length === count) opening.then(resolve);
    }});
    opening.then(({closed}) => closed.catch(reject), reject);
  });
  return {seen, made};
}

test('a page comes back after a server and a publisher that were killed', async () => {
  const page = await openPage(browser, pages.origin, 'webgl');
  await call(page, 'start', nats.options);
  await updates(page, 10);
  await nats.kill();
  await page.waitForFunction(() => window.page.events().some(({type}) => type === 'lost'));
  await nats.start();
  const goesOn = async () => {
    await updates(page, (await call(page, 'seen')).length + 30);
    const seen = await call(page, 'seen');
    for (const {color, gpu} of seen) assert.equal(gpu, color);
    // Before, regions that came again may be newer than others.
    for (const {color, vis} of seen.slice(-15)) assert.ok(states.has(`${color} ${vis}`), 'a state that was never published');
  };
  await goesOn();
  publisher.kill('SIGKILL');
  publisher = await publish();
  await goesOn();
  assert.equal((await call(page, 'events')).filter(({type}) => type === 'lost').length, 1);
  publisher.kill('SIGKILL');
  await page.waitForFunction(() => window.page.events().filter(({type}) => type === 'lost').length === 2);
  assert.match((await call(page, 'events')).at(-1).why, /nothing was published for 5 s/);
  publisher = await publish();
  await goesOn();
  await call(page, 'stop');
  await page.close();
});

test('Node follows, near regions alone, and leaves the connection to its maker', async () => {
  const connection = await connectNode();
  const {seen, made} = await follow(connection, {}, 20);
  for (const {color, vis} of seen) assert.ok(states.has(`${color} ${vis}`), 'a state that was never published');
  const {blocks} = made.client.state;
  made.close();
  assert.equal(await made.closed, '');
  let all = 0;
  const near = await connectNats(connection, {reach: 6, onUpdate: () => ++all});
  while (!near.client.state.connected) await setTimeout(10);
  assert.equal(near.client.state.blocks, 0);  // there is no viewpoint yet
  all = 0;
  near.client.setViewpoint({eye: [-14, 1.6, -14], target: [0, 1.5, 0]});
  near.send();
  while (all < 20) await setTimeout(10);
  assert.ok(near.client.state.blocks < blocks / 2, `${near.client.state.blocks} of ${blocks} blocks`);
  near.close();
  assert.equal(connection.isClosed(), false);
  await connection.close();
});

test('who may not look is told so', async () => {
  await assert.rejects(connectNode({pass: 'guess'}), {name: 'AuthorizationError'});
  const connection = await connectNode();
  const made = await connectNats(connection, {prefix: 'elsewhere'});
  await assert.rejects(made.closed, /may not look at that prefix/);
  await assert.rejects(connectNats(connection, {prefix: 'a..b'}), {name: 'TypeError', message: /^prefix:/});
  await connection.close();
  const page = await openPage(browser, pages.origin, 'webgl');
  await call(page, 'start', nats.options, {prefix: 'elsewhere'});
  await page.waitForFunction(() => window.page.events().some(({type}) => type === 'error'));
  assert.match((await call(page, 'events')).at(-1).error, /may not look/);
  await page.close();
  const open = await connectNode();
  const ended = await connectNats(open);
  await open.close();
  await assert.rejects(ended.closed, /connection to NATS was closed/);
});

test('a viewer may publish nothing', async () => {
  const connection = await connectNode();
  const refused = (async () => {
    for await (const {type, error} of connection.status()) if (type === 'error') return error.message;
  })();
  connection.publish('gicodec.list', 'mine');
  assert.match(await refused, /permissions violation/i);
  await connection.close();
});

test('what a hostile publisher says does no harm', async () => {
  const connection = await connectNode();
  const hostile = await connectNode(nats.publisher);
  let count = 0;
  const {seen, made} = await follow(connection, {}, 60, () => {
    for (const subject of ['list', 'tick', 'room.color.0.0.0.1', 'x.y.0.0.0']) {
      const message = randomBytes(1 + 37 * count % 500, ++count);
      if (count % 2) message.set([0x67, 0x69, 0x63, 0x73].slice(0, message.length));
      hostile.publish(`gicodec.${subject}`, message);
    }
  });
  for (const {color, vis} of seen) assert.ok(states.has(`${color} ${vis}`), 'a state that was never published');
  made.close();
  await Promise.all([connection.close(), hostile.close()]);
});

test('a receiver without a transport', async () => {
  const receiver = await TrackReceiver.create({reach: 3});
  assert.deepEqual(receiver.requests(), {list: true, objects: []});
  assert.deepEqual(receiver.requests(), {list: false, objects: []});
  for (let i = 1; i < 200; ++i) receiver.receive(randomBytes(i, i));
  assert.deepEqual([receiver.state.damaged, receiver.wanted, receiver.messages()], [199, [], []]);
  assert.equal(receiver.name({volume: 0, texture: 0, region: 0}), null);
  assert.throws(() => receiver.take(new Uint8Array(3)), {code: 'invalid_argument'});
  await assert.rejects(TrackReceiver.create({reach: -1}), {name: 'RangeError', message: /^reach/});
  await assert.rejects(TrackReceiver.create({far: 1}), {name: 'TypeError'});
});
