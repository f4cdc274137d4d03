// What the tests share. They run in a project that installed the package; GICODEC_SOURCE names the
// source tree, which has the golden files.
import {existsSync, readFileSync} from 'node:fs';
import {join} from 'node:path';

export const SOURCE = process.env.GICODEC_SOURCE;
export const golden = (name) => new Uint8Array(readFileSync(join(SOURCE, 'tests/golden', name)));

/** The path of a program of the build, which GICODEC_PROGRAMS names. */
export const program = (name) => ['gicodec', 'stream', 'programs']
    .map((folder) => join(process.env.GICODEC_PROGRAMS, folder, name)).find(existsSync);

/** Numbers as random as a test needs, the same in each run. */
export function* randomWords(seed = 1) {
  for (let state = seed;;) {
    state = (state + 0x6D2B79F5) | 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    yield (t ^ (t >>> 14)) >>> 0;
  }
}

export function randomBytes(size, seed) {
  const words = randomWords(seed);
  return Uint8Array.from({length: size}, () => words.next().value >>> 24);
}

/** FNV-1a of 64 bits, in hexadecimal. */
export function hashOf(array) {
  let low = 0x84222325, high = 0xCBF29CE4;
  for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength)) {
    low = (low ^ byte) >>> 0;
    // times 0x100000001B3
    const product = (low & 0xFFFF) * 0x1B3;
    const carried = (low >>> 16) * 0x1B3 + (product >>> 16);
    high = (Math.imul(high, 0x1B3) + (low << 8) + Math.floor(carried / 0x10000)) >>> 0;
    low = ((carried << 16) | (product & 0xFFFF)) >>> 0;
  }
  return high.toString(16).padStart(8, '0') + low.toString(16).padStart(8, '0');
}

export const bytes = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);
export const half = (...codes) => Uint16Array.from(codes);
