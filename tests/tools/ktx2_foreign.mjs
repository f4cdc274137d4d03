// ktx2_foreign.mjs MODULES FOLDER: reads the KTX2 files of FOLDER/manifest.json by ktx-parse of the
// folder MODULES, compares them with what the manifest says, and writes each once more as
// NAME.again.ktx2. Fails on the first difference.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { deflateSync, inflateSync } from 'node:zlib';

const [modules, folder] = process.argv.slice(2);
const { read, write } =
    await import(pathToFileURL(`${modules}/ktx-parse/dist/index.mjs`).href);

for (const want of JSON.parse(readFileSync(`${folder}/manifest.json`, 'utf8'))) {
  const ktx = read(new Uint8Array(readFileSync(`${folder}/${want.name}.ktx2`)));
  const what = want.name;
  assert.equal(ktx.vkFormat, want.format, what);
  assert.equal(ktx.typeSize, want.typeSize, what);
  assert.deepEqual([ktx.pixelWidth, ktx.pixelHeight, ktx.pixelDepth, ktx.layerCount], want.size, what);
  assert.equal(ktx.faceCount, want.faces, what);
  const zlib = 3;
  assert.equal(ktx.supercompressionScheme, want.packed ? zlib : 0, what);
  assert.equal(ktx.levels.length, want.levels, what);
  // Levels one after the other, the largest first.
  const levels = ktx.levels.map(({ levelData, uncompressedByteLength }) => {
    const level = want.packed ? inflateSync(levelData) : Buffer.from(levelData);
    assert.equal(level.length, uncompressedByteLength, what);
    return level;
  });
  assert.deepEqual(Buffer.concat(levels), readFileSync(`${folder}/${what}.texels`), what);
  // It is written again as another program packs it.
  if (want.packed) ktx.levels.forEach((level, i) => { level.levelData = deflateSync(levels[i], { level: 1 }); });
  for (const [key, value] of Object.entries(want.keys)) {
    // Of keys that are not its own it gives bytes, the final NUL included.
    assert.equal(Buffer.from(ktx.keyValue[key]).toString(), `${value}\0`, `${what}: ${key}`);
  }
  const [dfd, ...others] = ktx.dataFormatDescriptor;
  assert.equal(others.length, 0, what);
  assert.equal(dfd.bytesPlane[0], want.bytes, what);
  // How many bits of a texel are described: all of them, those that are shared more than once.
  const bits = new Set();
  for (const sample of dfd.samples) {
    for (let bit = 0; bit <= sample.bitLength; ++bit) bits.add(sample.bitOffset + bit);
  }
  assert.equal(bits.size, 8 * want.bytes, what);
  writeFileSync(`${folder}/${what}.again.ktx2`, write(ktx));
}
