// Decoders of packets: of one texture, and of all of a volume.
import {complete, createVolume, placeOf, texturesOf, withDesc} from './description.js';
import {GicodecError} from './error.js';
import {bytesOf} from './instance.js';
import {
  INVALID_ARGUMENT, decoderOptions, limits as limitsStruct, packetInfo,
} from './interface.js';

const PACKET_TYPES = ['keyframe', 'delta', 'intra', 'snapshot', 'catch-up', 'intra catch-up'];

/** A typed array for a texture, or the caller's if it fits. */
export function target(desc, into) {
  const out = into ?? new desc.ArrayType(desc.textureBytes / desc.ArrayType.BYTES_PER_ELEMENT);
  if (out.byteLength < desc.textureBytes) {
    throw new RangeError(`the texture has ${desc.textureBytes} bytes, the array ${out.byteLength}`);
  }
  return out;
}

/** Calls body(address) with a view that the library reads, of the caller's texture. */
export function withTexels(instance, memory, desc, array) {
  const bytes = bytesOf(array);
  if (bytes.length < desc.textureBytes) {
    throw new RangeError(`the texture has ${desc.textureBytes} bytes, the array ${bytes.length}`);
  }
  return {bytes: memory.put(bytes), size: bytes.length};
}

/** What the two decoders have in common: an instance, a handle, and the textures that they decode. */
class Packets {
  constructor(instance, handle, textures) {
    this.instance = instance;
    this.handle = handle;
    this.textures = textures;
  }

  static options(memory, {limits, firstTexture = 0}) {
    return memory.struct(decoderOptions,
        {textureId: firstTexture, limits: limits && memory.struct(limitsStruct, limits)});
  }

  /** Reads a texture by the library's call: read(address of a view). */
  read(place, into, read) {
    const desc = this.textures[place];
    const out = target(desc, into);
    return this.instance.into(out, desc.textureBytes, read);
  }
}

/** Turns the packets of one texture back into it. A packet is applied completely or not at all. */
export class Decoder {
  #packets;

  /** @internal */
  static async create(module, desc, options = {}) {
    const instance = await module.create();
    const decoder = new Decoder();
    decoder.desc = complete(instance, desc);
    const handle = withDesc(instance, desc, (at) => instance.with((memory) => {
      const out = memory.room(4);
      instance.check('decoder_create', [at, Packets.options(memory, options), out]);
      return instance.word(out);
    }));
    decoder.#packets = new Packets(instance, handle, [decoder.desc]);
    return decoder;
  }

  /** Applies a packet. */
  decode(packet) {
    const {instance, handle} = this.#packets;
    instance.with((memory) => instance.check(
        'decoder_decode', [handle, memory.put(packet), bytesOf(packet).length, 0], {what: 'the packet'}));
  }

  /** The texture, guard bands included, into an array of the caller's or a new one. */
  read(into) {
    const {instance, handle} = this.#packets;
    return this.#packets.read(0, into, (at) => instance.check('decoder_read', [handle, at, 0, 0]));
  }

  /** Which records exist, for a texture with presence. */
  setPresence(presence) {
    const {instance, handle} = this.#packets;
    instance.with((memory) => instance.check(
        'decoder_set_presence', [handle, memory.put(presence), bytesOf(presence).length]));
  }

  /** The blocks that the last packet may have changed, ascending. */
  changed() {
    return this.#packets.instance.borrowed(Uint32Array, 'decoder_changed', this.#packets.handle);
  }

  /** A byte for each block, not 0 if it was received. */
  received() {
    return this.#packets.instance.borrowed(Uint8Array, 'decoder_received', this.#packets.handle);
  }

  /** The number of the last packet; 0 before the first. */
  get sequence() {
    return this.#packets.instance.call('decoder_sequence', this.#packets.handle) >>> 0;
  }
}

/** Decodes the packets of a VolumeEncoder. */
export class VolumeDecoder {
  #packets;
  #first = 0;             // the number of the first texture in packets
  #changed = new Map();   // by texture, of the last update

  /** @internal */
  static async create(module, volume, options = {}) {
    const instance = await module.create();
    const decoder = new VolumeDecoder();
    decoder.textures = texturesOf(instance, volume);
    decoder.#first = options.firstTexture ?? 0;
    const handle = instance.with((memory) => {
      const out = memory.room(4);
      instance.check('volume_decoder_create',
          [createVolume(instance, volume), Packets.options(memory, options), out]);
      return instance.word(out);
    });
    decoder.#packets = new Packets(instance, handle, decoder.textures);
    return decoder;
  }

  /** Applies the packets of an update, in their order. */
  decode(packets) {
    const {instance, handle} = this.#packets;
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
    const {instance, handle} = this.#packets;
    const place = placeOf(this.textures, texture);
    return this.#packets.read(
        place, into, (at) => instance.check('volume_decoder_read', [handle, place, at, 0, 0]));
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

