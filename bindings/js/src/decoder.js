// Decoders of packets: of one texture, and of all of a volume.
import {complete, createVolume, placeOf, readTexture, texturesOf, withDesc} from './description.js';
import {GicodecError, checkOptions} from './error.js';
import {bytesOf} from './instance.js';
import {INVALID_ARGUMENT, decoderOptions, limits as limitsStruct, packetInfo} from './interface.js';

const PACKET_TYPES = ['keyframe', 'delta', 'intra', 'snapshot', 'catch-up', 'intra catch-up'];

/** The struct of a decoder's options, and what it points to. */
function withOptions(memory, options) {
  checkOptions(options, ['limits', 'firstTexture']);
  const {limits, firstTexture = 0} = options;
  return memory.struct(decoderOptions,
      {textureId: firstTexture, limits: limits && memory.struct(limitsStruct, limits)});
}

/** Turns the packets of one texture back into it. A packet is applied completely or not at all. */
export class Decoder {
  #instance;
  #handle;

  /** @internal */
  static async create(module, desc, options = {}) {
    const instance = await module.create();
    const decoder = new Decoder();
    decoder.#instance = instance;
    decoder.desc = complete(instance, desc);
    decoder.#handle = withDesc(instance, desc, (at) => instance.with((memory) =>
      instance.made('decoder_create', [at, withOptions(memory, options)])));
    return decoder;
  }

  /** Applies a packet. */
  decode(packet) {
    const [instance, handle] = [this.#instance, this.#handle];
    instance.with((memory) => instance.check(
        'decoder_decode', [handle, memory.put(packet), bytesOf(packet).length, 0], {what: 'the packet'}));
  }

  /** The texture, guard bands included, into an array of the caller's or a new one. */
  read(into) {
    return readTexture(this.#instance, this.desc, into, (at) =>
      this.#instance.check('decoder_read', [this.#handle, at, 0, 0]));
  }

  /** Which records exist, for a texture with presence. */
  setPresence(presence) {
    const [instance, handle] = [this.#instance, this.#handle];
    instance.with((memory) => instance.check(
        'decoder_set_presence', [handle, memory.put(presence), bytesOf(presence).length]));
  }

  /** The blocks that the last packet may have changed, ascending. */
  changed() {
    return this.#instance.borrowed(Uint32Array, 'decoder_changed', this.#handle);
  }

  /** A byte for each block, not 0 if it was received. */
  received() {
    return this.#instance.borrowed(Uint8Array, 'decoder_received', this.#handle);
  }

  /** The number of the last packet; 0 before the first. */
  get sequence() {
    return this.#instance.call('decoder_sequence', this.#handle) >>> 0;
  }
}

/** Decodes the packets of a VolumeEncoder. */
export class VolumeDecoder {
  #instance;
  #handle;
  #first = 0;             // the number of the first texture in packets
  #changed = new Map();   // by texture, of the last update

  /** @internal */
  static async create(module, volume, options = {}) {
    const instance = await module.create();
    const decoder = new VolumeDecoder();
    decoder.#instance = instance;
    decoder.textures = texturesOf(instance, volume);
    decoder.#first = options.firstTexture ?? 0;
    decoder.#handle = instance.with((memory) => instance.made(
        'volume_decoder_create', [createVolume(instance, volume), withOptions(memory, options)]));
    return decoder;
  }

  /** Applies the packets of an update, in their order. */
  decode(packets) {
    const [instance, handle] = [this.#instance, this.#handle];
    if (ArrayBuffer.isView(packets)) {
      throw new GicodecError(INVALID_ARGUMENT, 'decode() takes a list of packets');
    }
    this.#changed.clear();
    for (const packet of packets) {
      instance.with((memory) => {
        const [at, size] = [memory.put(packet), bytesOf(packet).length];
        instance.check('volume_decoder_decode', [handle, at, size], {what: 'a packet'});
        const info = memory.struct(packetInfo);
        instance.check('packet_peek', [at, size, info]);
        const place = instance.read(packetInfo, info).textureId - this.#first;
        this.#changed.set(place, instance.borrowed(Uint32Array, 'volume_decoder_changed', handle, place));
      });
    }
  }

  /** A texture by name or number, guard bands included. */
  read(texture, into) {
    const place = placeOf(this.textures, texture);
    return readTexture(this.#instance, this.textures[place], into, (at) =>
      this.#instance.check('volume_decoder_read', [this.#handle, place, at, 0, 0]));
  }

  /** The blocks of a texture that the last update may have changed, ascending. */
  changed(texture) {
    return this.#changed.get(placeOf(this.textures, texture))?.slice() ?? new Uint32Array();
  }
}

/** The head of a packet, without a decoder. */
export async function peek(module, packet) {
  const instance = await module.create();
  return instance.with((memory) => {
    const info = memory.struct(packetInfo);
    instance.check('packet_peek', [memory.put(packet), bytesOf(packet).length, info], {what: 'the packet'});
    const {type, backend, lossy, allBlocks, ...head} = instance.read(packetInfo, info);
    return {...head, type: PACKET_TYPES[type], backend: instance.text(instance.call('backend_name', backend)),
            lossy: lossy !== 0, allBlocks: allBlocks !== 0};
  });
}

