// Encoders: of one texture, and of all of a volume.
import {
  complete, createVolume, formatNumber, numberOf, placeOf, readDesc, readTexture, texelsOf, texturesOf,
  withDesc,
} from './description.js';
import {checkOptions} from './error.js';
import {bytesOf} from './instance.js';
import {
  BUFFER_TOO_SMALL, SELECT_ALL, SELECT_CHANGED, SELECT_LIST, constView, encoderOptions, textureDesc,
} from './interface.js';

/** The struct of an encoder's options, and what it points to. */
function withOptions(memory, options) {
  checkOptions(options, ['preset', 'gop', 'chunk', 'maxError', 'firstTexture']);
  const {preset, maxError = 0, gop, firstTexture = 0, chunk} = options;
  if (preset !== undefined) numberOf(PRESETS, String(preset), 'preset');
  const list = Array.isArray(maxError) || ArrayBuffer.isView(maxError);
  return memory.struct(encoderOptions, {
    chunk, textureId: firstTexture, preset: preset && memory.text(preset),
    gop: gop === 0 ? 0xFFFFFFFF : gop, maxError: list ? 0 : maxError,
    maxErrors: list ? memory.put(Float32Array.from(maxError)) : 0, maxErrorCount: list ? maxError.length : 0,
  });
}

const PRESETS = ['turbo', 'fast', 'strong'];

/** What the library takes for "changed", "all" or a list of blocks. */
function selection(memory, blocks) {
  if (blocks === 'changed') return [SELECT_CHANGED, 0, 0];
  if (blocks === 'all') return [SELECT_ALL, 0, 0];
  if (typeof blocks === 'string' || typeof blocks?.[Symbol.iterator] !== 'function') {
    throw new TypeError(`blocks are "changed", "all" or a list of numbers, not ${blocks}`);
  }
  const list = Uint32Array.from(blocks);
  return [SELECT_LIST, memory.put(list), list.length];
}

/** Turns successive contents of one texture into packets; the first one is a keyframe. */
export class Encoder {
  #instance;
  #handle;

  /** @internal */
  static async create(module, desc, options = {}) {
    const instance = await module.create();
    const encoder = new Encoder();
    encoder.#instance = instance;
    encoder.desc = complete(instance, desc);
    encoder.#handle = withDesc(instance, desc, (at) => instance.with((memory) =>
      instance.made('encoder_create', [at, withOptions(memory, options)])));
    return encoder;
  }

  /** A packet of the blocks that changed, of "all", or of a list of block numbers. */
  encode(texture, blocks = 'changed') {
    const instance = this.#instance;
    return instance.with((memory) => {
      const texels = memory.struct(constView, texelsOf(memory, this.desc, texture));
      const chosen = selection(memory, blocks);
      return this.#packet(memory, (out, capacity, size) => instance.check(
          'encoder_encode', [this.#handle, texels, ...chosen, out, capacity, size], {also: [BUFFER_TOO_SMALL]}));
    });
  }

  /** A keyframe of what decoders hold, for those that join late. */
  snapshot() {
    const instance = this.#instance;
    return instance.with((memory) => this.#packet(memory, (out, capacity, size) => instance.check(
        'encoder_snapshot', [this.#handle, out, capacity, size], {also: [BUFFER_TOO_SMALL]})));
  }

  #packet(memory, write) {
    const size = memory.room(4);
    const bound = this.#instance.call('encoder_bound', this.#handle, this.desc.blocks) >>> 0;
    const out = memory.room(bound);
    if (write(out, bound, size) === BUFFER_TOO_SMALL) throw this.#instance.error(BUFFER_TOO_SMALL);
    return this.#instance.bytes(out, this.#instance.word(size)).slice();
  }

  /** Makes the next packet a keyframe. */
  requestKeyframe() {
    this.#instance.check('encoder_request_keyframe', [this.#handle]);
  }

  setPreset(preset) {
    this.#instance.with((memory) =>
      this.#instance.check('encoder_set_preset', [this.#handle, memory.text(preset)]));
  }

  /** Leaves inactive blocks out of "changed": a truth value for each; null: all are active. */
  setActive(active) {
    const mask = active === null ? new Uint8Array() : Uint8Array.from(active, Number);
    this.#instance.with((memory) => this.#instance.check(
        'encoder_set_active', [this.#handle, mask.length ? memory.put(mask) : 0, mask.length]));
  }

  /** Which records exist, for a texture with presence. */
  setPresence(presence) {
    this.#instance.with((memory) => this.#instance.check(
        'encoder_set_presence', [this.#handle, memory.put(presence), bytesOf(presence).length]));
  }

  /** The texture as decoders hold it. */
  read(into) {
    return readTexture(this.#instance, this.desc, into, (at) =>
      this.#instance.check('encoder_read', [this.#handle, at]));
  }

  /** The number of the last packet; 0 before the first. */
  get sequence() {
    return this.#instance.call('encoder_sequence', this.#handle) >>> 0;
  }
}

/** Turns successive contents of all textures of a volume into updates: one packet for each. */
export class VolumeEncoder {
  #instance;
  #handle;

  /** @internal */
  static async create(module, volume, options = {}) {
    const instance = await module.create();
    const encoder = new VolumeEncoder();
    encoder.#instance = instance;
    encoder.textures = texturesOf(instance, volume);
    encoder.#handle = instance.with((memory) => instance.made(
        'volume_encoder_create', [createVolume(instance, volume), withOptions(memory, options)]));
    return encoder;
  }

  /** The packets of an update, in the order in which decoders must apply them. */
  encode(textures, blocks = 'changed') {
    const instance = this.#instance;
    for (const name of Object.keys(textures)) placeOf(this.textures, name);
    instance.with((memory) => {
      const views = memory.list(constView, this.textures.map((desc) => {
        if (!textures[desc.name]) throw new TypeError(`the volume has a texture "${desc.name}", which is missing`);
        return texelsOf(memory, desc, textures[desc.name]);
      }));
      instance.check('volume_encoder_encode',
          [this.#handle, views, this.textures.length, ...selection(memory, blocks)]);
    });
    return this.#packets();
  }

  /** Keyframes of what decoders hold. */
  snapshot() {
    this.#instance.check('volume_encoder_snapshot', [this.#handle]);
    return this.#packets();
  }

  #packets() {
    const count = this.#instance.call('volume_encoder_packets', this.#handle);
    return Array.from({length: count}, (_, place) =>
      this.#instance.borrowed(Uint8Array, 'volume_encoder_packet', this.#handle, place));
  }

  requestKeyframe() {
    this.#instance.check('volume_encoder_request_keyframe', [this.#handle]);
  }

  /** The preset of a texture's next packets. */
  setPreset(texture, preset) {
    this.#instance.with((memory) => this.#instance.check('volume_encoder_set_preset',
        [this.#handle, placeOf(this.textures, texture), memory.text(preset)]));
  }
}

/** A description that a call of the library makes of numbers. */
export async function described(module, call, numbers, format) {
  const instance = await module.create();
  return instance.with((memory) => {
    const at = memory.struct(textureDesc);
    instance.check(call, [...numbers, formatNumber(instance, format), at]);
    return readDesc(instance, at);
  });
}

/** Sides along x, y, z; 1 for those that are not given. */
export function sides(what, numbers, least) {
  const list = Array.isArray(numbers) || ArrayBuffer.isView(numbers) ? Array.from(numbers) : [];
  const whole = (side) => Number.isInteger(side) && side > 0 && side < 2 ** 32;
  if (list.length < least || list.length > 3 || !list.every(whole)) {
    throw new RangeError(`${what} is a list of ${least === 3 ? '3' : `${least} to 3`} whole numbers from 1 on, not ` +
                         JSON.stringify(numbers));
  }
  return [...list, 1, 1].slice(0, 3);
}

/** The volume of an engine's layout: a plain object. */
export async function volumeOf(module, layout, grid) {
  const instance = await module.create();
  numberOf(Object.keys(layoutsOf(instance)), String(layout), 'layout');
  return instance.with((memory) => instance.json('volume_desc_json', instance.made(
      'volume_desc_from_layout', [memory.text(layout), ...grid], {what: `${layout} ${grid.join(' × ')}`})));
}

/** Engines' layouts, and a line about each. */
export async function layouts(module) {
  return layoutsOf(await module.create());
}

function layoutsOf(instance) {
  const count = instance.call('layout_count');
  return Object.fromEntries(Array.from({length: count}, (_, place) =>
    ['layout_name', 'layout_summary'].map((call) => instance.text(instance.call(call, place)))));
}

/** All formats, by VkFormat's name without VK_FORMAT_. */
export async function formats(module) {
  const instance = await module.create();
  return Array.from({length: instance.call('format_count')}, (_, place) =>
    instance.text(instance.call('format_name', instance.call('format_at', place))));
}
