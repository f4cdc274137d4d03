import assert from 'node:assert/strict';
import {Readable} from 'node:stream';
import {test} from 'node:test';

import {Player, open, useWorkers} from 'gicodec';

import {bytes, golden, hashOf, randomWords} from './support.mjs';

const FILE = 'native_fast.gic';

/** Frames and hashes, read as a caller does. */
async function played(player) {
  const found = [];
  for await (const frame of player) {
    for (const {name} of player.textures) found.push([frame, name, hashOf(await player.read(name))]);
  }
  return found;
}

/** A stream of small chunks that tells how much was asked of it. */
function trickle(data, size) {
  let at = 0;
  const stream = new ReadableStream({
    pull(controller) {
      if (at >= data.length) return controller.close();
      controller.enqueue(data.slice(at, at + size));
      at += size;
    },
  }, {highWaterMark: 0});
  return {stream, asked: () => Math.min(at, data.length)};
}

test('any source gives the same', async () => {
  const data = golden(FILE);
  const expected = await played(await open(data));
  assert.equal(expected.length, 18);
  const sources = {
    buffer: data.slice().buffer, blob: new Blob([data]), response: new Response(data),
    promise: Promise.resolve(new Response(data)), stream: trickle(data, 1000).stream,
    node: Readable.from([data.slice(0, 100), data.slice(100)]),
    odd: trickle(data, 7).stream, view: new DataView(data.buffer, data.byteOffset, data.byteLength),
  };
  for (const [name, source] of Object.entries(sources)) {
    assert.deepEqual(await played(await open(source)), expected, name);
  }
  assert.deepEqual(data, golden(FILE));  // nobody took it
});

test('frames come before the end of a stream', async () => {
  const data = golden(FILE);
  const {stream, asked} = trickle(data, 256);
  const player = await open(stream);
  assert.ok(asked() < data.length / 4, `opened after ${asked()} of ${data.length} bytes`);
  assert.equal(await player.next(), 0);
  assert.ok(asked() < data.length * 0.9, `the first frame after ${asked()} of ${data.length} bytes`);
  assert.equal(hashOf(await player.read(0)), (await played(await open(data)))[0][2]);
  player.close();
});

test('seeking, and what changed', async () => {
  const player = await open(golden(FILE));
  const frames = await player.frames();
  assert.equal(frames.length, 3);
  for await (const _ of player);
  const last = hashOf(await player.read(0));
  await player.seek(frames[0]);
  assert.equal(await player.next(), frames[0]);
  assert.equal((await player.changed(0)).length, player.textures[0].blocks);
  await player.seek(frames[2]);
  await player.next();
  assert.equal(hashOf(await player.read(0)), last);
  await assert.rejects(player.seek(99), {code: 'unknown_frame'});
});

test('some textures alone', async () => {
  const player = await open(golden(FILE), {textures: [1]});
  await player.next();
  const all = await open(golden(FILE));
  await all.next();
  assert.deepEqual(await player.read(1), await all.read(1));
  await assert.rejects(player.read(0), /is not among the textures/);
  await assert.rejects((await open(golden(FILE))).read(0), /call next\(\) before/);
  await assert.rejects(open(golden(FILE), {textures: ['nobody']}), /there is no texture "nobody": there are/);
});

test('workers decode the same, and take buffers in turn', async () => {
  const expected = await played(await open(golden(FILE)));
  await useWorkers(2);
  try {
    const players = await Promise.all([1, 2, 3, 4].map(() => open(golden(FILE))));
    for (const found of await Promise.all(players.map(played))) assert.deepEqual(found, expected);
    const [player] = players;
    const {textureBytes, ArrayType} = player.textures[0];
    const into = new ArrayType(textureBytes / ArrayType.BYTES_PER_ELEMENT);
    const back = await player.read(0, into);
    assert.equal(into.length, 0);  // transferred
    assert.equal(back.constructor, ArrayType);
    assert.equal(hashOf(back), expected.at(-6)[2]);
    assert.deepEqual(await played(await open(trickle(golden(FILE), 999).stream)), expected);
    await assert.rejects(open(new Uint8Array(100)), {name: 'GicodecError', code: 'not_gicodec'});
    await assert.rejects(player.read('nobody'), RangeError);
    await assert.rejects(player.read(0, into), /into was handed to a worker/);
    assert.equal(hashOf(await player.read(0)), expected.at(-6)[2]);
    players.slice(1).forEach((one) => one.close());
    const late = player.next();
    await useWorkers(1);
    await assert.rejects(late, /open the container again/);
    await assert.rejects(player.read(0), /open the container again/);
    player.close();
  } finally {
    await useWorkers(0);
  }
  assert.deepEqual(await played(await open(golden(FILE))), expected);
});

test('an AbortSignal ends it', async () => {
  const stop = new AbortController();
  let cancelled;
  const stuck = new ReadableStream({
    start(controller) { controller.enqueue(golden(FILE).slice(0, 40)); },
    cancel(reason) { cancelled = reason; },
  });
  const opening = open(stuck, {signal: stop.signal});
  setTimeout(() => stop.abort(new Error('enough')), 20);
  await assert.rejects(opening, /enough/);
  assert.match(cancelled.message, /enough/);
  await assert.rejects(open(golden(FILE), {signal: AbortSignal.abort()}), {name: 'AbortError'});
  const other = new AbortController();
  const player = await open(golden(FILE), {signal: other.signal});
  await player.next();
  other.abort();
  await assert.rejects(player.next(), {name: 'AbortError'});
});

test('an AbortSignal ends the wait for a source', async () => {
  const stop = new AbortController();
  const opening = open(new Promise(() => {}), {signal: stop.signal});
  setTimeout(() => stop.abort(), 20);
  await assert.rejects(opening, {name: 'AbortError'});
});

test('small pieces go to workers together', async () => {
  const data = golden(FILE);
  const expected = await played(await open(data));
  await useWorkers(1);
  const pieces = Array.from({length: Math.ceil(data.length / 50)}, (_, i) => data.slice(50 * i, 50 * (i + 1)));
  assert.deepEqual(await played(await open(Readable.from(pieces))), expected);
  const into = new Uint8Array(new SharedArrayBuffer((await open(data)).textures[0].textureBytes));
  const player = await open(data);
  await player.next();
  assert.deepEqual(hashOf(await player.read(0, into)), expected[0][2]);
  await assert.rejects(useWorkers(1000), RangeError);
  await useWorkers(0);
});

test('errors say what and where', async () => {
  await assert.rejects(open(new Uint8Array()), {code: 'truncated'});
  await assert.rejects(open(golden('bad_magic.gic')), {code: 'not_gicodec'});
  const page = new Response('<!doctype html><title>Not here</title>', {headers: {'content-type': 'text/html'}});
  await assert.rejects(open(page), {code: 'not_gicodec', message: /brings text\/html/});
  await assert.rejects(open(golden('bad_major.gic')),
      {code: 'unsupported_version', message: /has version 3\.0, and gicodec \d.* reads version 1: take a newer/});
  await assert.rejects(open(new Response('gone', {status: 404, statusText: 'Not Found'})), /404 Not Found/);
  await assert.rejects(open('room.gic'), /not room.gic: open\(fetch\(url\)\) takes/);
  await assert.rejects(open(golden(FILE), {limits: {maxTextureBytes: 100}}), {code: 'limit_exceeded'});
  await assert.rejects(open(golden(FILE), {limits: {maxBytes: 100}}), /there is no maxBytes/);
  const cut = await Player.open(golden(FILE).slice(0, -200));
  await assert.rejects(played(cut), {code: 'truncated'});
  const closed = await open(golden(FILE));
  closed.close();
  await assert.rejects(closed.next(), /the player is closed/);
});

test('damaged containers end with a status', async () => {
  const words = randomWords(7);
  const random = (below) => words.next().value % below;
  const statuses = new Map();
  for (let i = 0; i < 1500; ++i) {
    const name = [FILE, 'maps_strong.gic', 'native_turbo.gic', 'regions.gic', 'volumes.gic'][i % 5];
    const data = golden(name);
    for (let n = 1 + random(4); n > 0; --n) data[random(data.length)] = random(256);
    const source = i % 2 ? data.slice(0, random(data.length + 1)) : data;
    try {
      await played(await open(source, {limits: {maxTotalBytes: 1 << 26}}));
    } catch (error) {
      assert.equal(error.name, 'GicodecError', `case ${i}: ${error.stack}`);
      assert.notEqual(error.code, 'out_of_memory', `case ${i}: ${error.stack}`);
      statuses.set(error.code, (statuses.get(error.code) ?? 0) + 1);
    }
  }
  assert.ok(statuses.size >= 4, JSON.stringify([...statuses]));
});

test('reading into memory of the caller\'s', async () => {
  const player = await open(golden(FILE));
  await player.next();
  const {textureBytes} = player.textures[0];
  const memory = new ArrayBuffer(textureBytes + 64);
  const found = await player.read(0, new Uint8Array(memory, 32, textureBytes));
  assert.ok(bytes(found).equals(bytes(await player.read(0))));
  assert.ok(bytes(new Uint8Array(memory, 0, 32)).every((byte) => byte === 0));
  await assert.rejects(player.read(0, new Uint8Array(10)), /bytes, the array 10/);
});
