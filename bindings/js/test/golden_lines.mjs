// Golden containers have the hashes of tests/golden/hashes.txt, as in C++, C and Python.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {open} from 'gicodec';

import {golden, hashOf} from './support.mjs';

// What the package has no backend for ends with "backend_missing", or as it would with one.
const BACKEND_MISSING = 402;

async function linesOf(name) {
  const lines = [];
  try {
    const player = await open(golden(name));
    for await (const frame of player) {
      for (let i = 0; i < player.textures.length; ++i) {
        if (player.textures[i].grid) lines.push(`${name} ${frame} ${i} ${hashOf(await player.read(i))}`);
      }
    }
    lines.push(`${name} ends 1`);
  } catch (error) {
    assert.equal(error.name, 'GicodecError', `${name}: ${error.stack}`);
    lines.push(`${name} ends ${error.status}`);
  }
  return lines;
}

export function testGolden(what) {
  const expected = new Map();
  for (const line of new TextDecoder().decode(golden('hashes.txt')).trim().split('\n')) {
    const [name] = line.split(' ');
    expected.set(name, [...(expected.get(name) ?? []), line]);
  }
  test(`golden containers, ${what}`, async () => {
    let same = 0;
    const missing = [];
    for (const [name, lines] of expected) {
      const found = await linesOf(name);
      if (found.at(-1) === `${name} ends ${BACKEND_MISSING}`) {
        missing.push(name);
        continue;
      }
      assert.deepEqual(found, lines);
      ++same;
    }
    assert.ok(same > 40, `${same}`);
    assert.deepEqual(missing.filter((name) => /native|raw|maps/.test(name)), []);
    assert.ok(missing.includes('sequence_zstd.gic') && missing.includes('sequence_lz4.gic'));
  });
}
