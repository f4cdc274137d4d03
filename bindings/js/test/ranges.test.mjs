// Containers on servers of files: how often and how much they are asked, and servers with faults.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {createServer} from 'node:http';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';

import {fetchRanges, open} from 'gicodec';
import {Writer, mapTexture} from 'gicodec/encoder';

import {SOURCE, bytes, program, randomBytes} from './support.mjs';

const EDGE = 64 << 10;
let server, file, frames;

/** Serves `file`; `fault` of a URL's path changes answers. `rounds`: groups of requests that were sent together. */
function begin() {
  const state = {sent: 0, requests: 0, rounds: 0, open: 0, counts: {}};
  const answer = ({url, headers}, response) => {
    const fault = url.slice(1), count = state.counts[fault] = (state.counts[fault] ?? 0) + 1;
    const asked = /^bytes=(\d*)-(\d+)$/.exec(headers.range ?? '');
    let [first, last] = [0, file.length - 1];
    if (asked?.[1]) [first, last] = [Number(asked[1]), Math.min(Number(asked[2]), last)];
    else if (asked) first = Math.max(0, file.length - Number(asked[2]));
    if (fault === 'whole') return response.writeHead(200).end(file);
    const later = count > 2;
    const body = Buffer.from(file.subarray(first, later && fault === 'shorter' ? last : last + 1));
    const total = file.length + (later && fault === 'total' ? 1 : 0);
    state.sent += body.length;
    response.writeHead(206, {'content-length': body.length, 'content-range': `bytes ${first}-${last}/${total}`,
                             etag: later && fault === 'mark' ? '"b"' : '"a"'}).end(body);
  };
  // Those that come within a moment were sent together.
  const http = createServer((request, response) => {
    ++state.requests;
    if (state.open++ === 0) ++state.rounds;
    setTimeout(() => {
      --state.open;
      answer(request, response);
    }, 150);
  });
  return new Promise((resolve) => http.listen(0, '127.0.0.1', () => resolve(Object.assign(state, {
    origin: `http://127.0.0.1:${http.address().port}`,
    reset: () => Object.assign(state, {sent: 0, requests: 0, rounds: 0}),
    close: () => new Promise((done) => { http.close(done); http.closeAllConnections(); }),
  }))));
}

before(async () => {
  const desc = await mapTexture([8, 8], 'R8G8B8A8_UNORM');
  const writer = await Writer.create({map: {kind: 'textures', textures: [{name: 'noise', ...desc}]}}, {preset: 'turbo', gop: 20});
  frames = [];
  for (let frame = 0; frame < 3000; ++frame) {
    const texels = randomBytes(256, frame + 1);
    frames.push(bytes(texels));
    writer.add(frame, {noise: new desc.ArrayType(texels.buffer)});
  }
  file = writer.finish();
  server = await begin();
});
after(() => server.close());

test('any frame is three round trips away', async () => {
  for (const frame of [0, 1, 1499, 2999]) {
    server.reset();
    const player = await open(fetchRanges(`${server.origin}/sound`));
    if (frame > 0) await player.seek(frame);
    assert.equal(await player.next(), frame);
    assert.deepEqual(bytes(await player.read(0)), frames[frame]);
    assert.ok(server.rounds <= 3, `${frame}: ${server.rounds} round trips, ${server.requests} requests`);
    assert.ok(server.sent < 4 * EDGE, `${frame}: ${server.sent} of ${file.length} bytes`);
    player.close();
  }
});

test('in order all come, in windows that grow', async () => {
  server.reset();
  const player = await open(fetchRanges(`${server.origin}/sound`));
  const found = [];
  for await (const frame of player) {
    found.push(frame);
    if (frame % 500 === 0) assert.deepEqual(bytes(await player.read(0)), frames[frame]);
  }
  assert.equal(found.length, 3000);
  assert.ok(server.rounds <= 20, `${server.rounds} round trips`);
  assert.ok(server.sent < 1.2 * file.length, `${server.sent} of ${file.length} bytes`);
  player.close();
});

test('a file that was cut off plays to its end', async () => {
  const whole = file;
  try {
    file = whole.subarray(0, whole.length * 2 / 3);
    const player = await open(fetchRanges(`${server.origin}/sound`));
    let last = null;
    await assert.rejects(async () => {
      for await (const frame of player) last = frame;
    }, {code: 'truncated'});
    assert.ok(last > 1500, `frame ${last}`);
    assert.deepEqual(bytes(await player.read(0)), frames[last]);
    player.close();
  } finally {
    file = whole;
  }
});

test('a file that grows is followed to its end', async () => {
  const whole = file;
  let timer;
  try {
    file = whole.subarray(0, whole.length / 2);
    const player = await open(fetchRanges(`${server.origin}/grows`), {follow: true});
    await player.seek(1400);
    timer = setInterval(() => (file = whole.subarray(0, Math.min(whole.length, file.length + 70_001))), 100);
    let last = null;
    for await (const frame of player) {
      assert.equal(frame, last === null ? 1400 : last + 1);
      last = frame;
      if (frame % 300 === 0) assert.deepEqual(bytes(await player.read(0)), frames[frame]);
    }
    assert.equal(last, 2999);
    player.close();
    file = whole.subarray(0, whole.length / 2);
    const other = await open(fetchRanges(`${server.origin}/grows`), {follow: true});
    await other.seek(1400);
    clearInterval(timer);
    file = randomBytes(whole.length, 99);
    await assert.rejects(async () => {
      while (await other.next() !== null);
    }, /changed while it was read/);
  } finally {
    clearInterval(timer);
    file = whole;
  }
});

test('a corner of a volume that is cut costs its own bytes', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'gicodec-cut-')), whole = file;
  try {
    const cut = join(folder, 'cut.gic'), dumps = join(SOURCE, 'testdata/villa-converged');
    execFileSync(program('gicodec'), ['encode', '-q', '--region', '4x4x4', '-o', cut, dumps]);
    file = new Uint8Array(readFileSync(cut));
    const all = await open(file), some = await open(fetchRanges(`${server.origin}/sound`), {box: {first: [0, 0, 0], last: [2, 1, 1]}});
    for (let frame = 0; frame < 2; ++frame) {
      assert.equal(await all.next(), await some.next());
    }
    const [texels, corner] = [bytes(await all.read('color')), bytes(await some.read('color'))];
    assert.notDeepEqual(texels, corner);
    const there = corner.filter((byte, i) => byte !== 0 && byte === texels[i]).length;
    assert.ok(there > 0 && corner.every((byte, i) => byte === 0 || byte === texels[i]));
    for (const [box, message] of [[{volume: 'x', first: [0, 0, 0], last: [1, 1, 1]}, /no volume "x"/],
                                  [{first: [0, 0], last: [1, 1, 1]}, /first and last/]]) {
      await assert.rejects(open(file, {box}), message);
    }
  } finally {
    file = whole;
    rmSync(folder, {recursive: true});
  }
});

test('a server without parts sends all', async () => {
  const player = await open(fetchRanges(`${server.origin}/whole`));
  assert.equal(await player.next(), 0);
  player.close();
});

test('what changes or is cut meanwhile is said', async () => {
  for (const [fault, message] of [['total', /changed while it was read/], ['mark', /changed while it was read/],
                                  ['shorter', /brings \d+ bytes from \d+ on, not \d+/]]) {
    await assert.rejects(async () => {
      const player = await open(fetchRanges(`${server.origin}/${fault}`));
      await player.seek(1499);
      await player.next();
    }, message, fault);
  }
});
