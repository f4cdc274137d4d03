// The client beside a real server: gi-server --listen-web, by the package ws; and what hostile bytes do.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {setTimeout} from 'node:timers/promises';

import WebSocket, {WebSocketServer} from 'ws';

import {open} from 'gicodec';
import {Client, connect} from 'gicodec/client';

import {giServer} from './gi_server.mjs';
import {SOURCE, bytes, hashOf, program, randomWords} from './support.mjs';

let folder, server, url, file;

function run(program, ...options) {
  return new Promise((resolve, reject) => {
    const child = spawn(program, options, {stdio: ['ignore', 'pipe', 'pipe']});
    let text = '';
    for (const stream of [child.stdout, child.stderr]) stream.on('data', (data) => (text += data));
    child.on('exit', (code) => (code === 0 ? resolve(text) : reject(new Error(`${program}: ${text}`))));
  });
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'gicodec-'));
  file = join(folder, 'room.gic');
  await run(program('gi-trace'), '--scene', 'tomb', '--grid', '4x2x4', '--frames', '6', '--fps', '3', '-o', file);
  server = await giServer(file);
  url = `ws://${server.address}`;
});

after(() => {
  server?.child.kill();
  rmSync(folder, {recursive: true, force: true});
});

test('a client holds what the server plays', async () => {
  let updates = 0, serial = 0;
  const shown = [];
  const connection = await new Promise((resolve, reject) => {
    const opening = connect(url, {WebSocket, onUpdate(client) {
      const [room] = client.volumes;
      const changed = room.changed(0, serial);
      assert.ok(changed.every((block) => block < room.textures[0].blocks));
      serial = client.state.serial;
      shown.push(Buffer.from(bytes(room.texels(0))).toString('base64'));
      if (++updates === 8) opening.then(resolve);
    }});
    opening.then((made) => made.closed.catch(reject), reject);
  });
  const {client} = connection;
  const [room] = client.volumes;
  assert.equal(room.kind, 'probes');
  assert.deepEqual(room.geometry.grid, [4, 2, 4]);
  assert.equal(client.state.connected, true);
  assert.ok(client.state.blocks > 0);
  assert.deepEqual(room.read(0), room.texels(0).slice());
  const player = await open(readFileSync(file));
  const played = new Set();
  for await (const _ of player) played.add(Buffer.from(bytes(await player.read(0))).toString('base64'));
  for (const one of shown) assert.ok(played.has(one), 'a frame that the file does not have');
  connection.close();
  assert.equal(await connection.closed, '');
});

test('an AbortSignal ends a connection', async () => {
  const stop = new AbortController();
  const connection = await connect(url, {WebSocket, signal: stop.signal});
  setTimeout(50).then(() => stop.abort());
  await assert.rejects(connection.closed, {name: 'AbortError'});
});

test('it comes back after a lost connection', async () => {
  const sockets = [];
  class Counted extends WebSocket {
    constructor(...options) {
      super(...options);
      sockets.push(this);
    }
  }
  let resumed;
  const done = new Promise((resolve) => (resumed = resolve));
  const connection = await connect(url, {WebSocket: Counted, onUpdate(client) {
    if (sockets.length === 1) sockets[0].terminate();
    else if (client.state.resumed) resumed(true);
  }});
  assert.equal(await done, true);
  connection.close();
});

test('recorded sessions have the hashes of C++, C and Python', async () => {
  const folder = join(SOURCE, 'tests/session/golden');
  const expected = readFileSync(join(folder, 'hashes.txt'), 'utf8').trim().split('\n');
  for (const name of ['shared_native.session', 'unicast_native.session', 'unicast_raw.session', 'shared_zstd.session']) {
    const client = await Client.create({delivery: name.split('_')[0], token: 'token'});
    client.hello();
    const data = readFileSync(join(folder, name));
    const lines = [];
    const play = () => {
      for (let at = 0, serial = 0; at < data.length;) {
        const fromServer = data[at] === 1, size = data.readUInt32LE(at + 1);
        const message = data.subarray(at + 5, at + 5 + size);
        at += 5 + size;
        if (!fromServer) continue;
        client.receive(message);
        const {state, volumes: [room]} = client;
        if (state.serial === serial) continue;
        serial = state.serial;
        room.textures.forEach((_, place) =>
          lines.push(`${name} ${state.update} ${place} ${hashOf(room.texels(place))}`));
      }
    };
    if (name.includes('zstd')) {  // of which the package has no decoder
      assert.throws(play, {code: 'backend_missing'});
      continue;
    }
    play();
    assert.deepEqual(lines, expected.filter((line) => line.startsWith(name)));
    assert.equal(client.state.reason, 'the server ends');
  }
});

test('it comes back to a server that ended and began again', async () => {
  let {child: own, address} = await giServer(file);
  const lost = [];
  let again;
  const done = new Promise((resolve) => (again = resolve));
  const epochs = new Set();
  const connection = await connect(`ws://${address}`, {
    WebSocket, onLost: (wait, why) => lost.push(why),
    onUpdate(client) {
      epochs.add(client.state.epoch);
      if (epochs.size === 1) own.kill('SIGTERM');
      else again();
    },
  });
  await new Promise((resolve) => own.on('exit', resolve));
  assert.equal(connection.client.state.connected, false);
  ({child: own} = await giServer(file, {address}));
  await done;
  assert.equal(lost[0], 'the server ends');
  connection.close();
  own.kill();
});

test('a server that says nothing counts as lost', async () => {
  const silent = new WebSocketServer({port: 0, host: '127.0.0.1'});
  await new Promise((resolve) => silent.on('listening', resolve));
  const why = await new Promise((resolve, reject) => {
    const stop = new AbortController();
    connect(`ws://127.0.0.1:${silent.address().port}`, {
      WebSocket, timeout: 200, signal: stop.signal,
      onLost: (_, reason) => (stop.abort(), resolve(reason)),
    }).catch(reject);
  });
  assert.match(why, /nothing came for 0.2 s/);
  silent.close();
  silent.clients.forEach((client) => client.terminate());
});

test('a client without a transport', async () => {
  const client = await Client.create({delivery: 'shared', token: 'x'});
  assert.ok(client.hello().length > 0);
  assert.deepEqual(client.volumes, []);
  assert.throws(() => client.setViewpoint({eye: [0, 0, NaN], target: [0, 0, 0]}), {code: 'invalid_argument'});
  const words = randomWords(3);
  for (let i = 0; i < 300; ++i) {
    const hostile = await Client.create();
    hostile.hello();
    const message = Uint8Array.from({length: words.next().value % 90}, () => words.next().value);
    if (i % 2) message.set([0x67, 0x69, 0x63, 0x73].slice(0, message.length));
    assert.throws(() => hostile.receive(message), {name: 'GicodecError'});
  }
});
