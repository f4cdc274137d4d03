// Containers, written frame by frame: with the encoders that make their packets.
import {createVolume, texturesOf} from './description.js';
import {VolumeEncoder} from './encoder.js';
import {GicodecError} from './error.js';
import {bytesOf, frameNumber} from './instance.js';
import {
  METADATA_CONTAINER, METADATA_TEXTURE, METADATA_VOLUME, OUT_OF_ORDER, geometry as geometryStruct,
} from './interface.js';

/** The arrays of a volume, rather than an array or nothing. */
function isTextures(value) {
  return typeof value === 'object' && value !== null && !ArrayBuffer.isView(value) &&
         !/ArrayBuffer\]$/.test(Object.prototype.toString.call(value));
}

/** Writes a container of several volumes. */
export class Writer {
  #instance;
  #handle;
  #encoders = new Map();
  #ended = false;

  /** @internal */
  static async create(module, volumes, {scene = '', metadata = {}, ...options} = {}) {
    const instance = await module.create();
    const writer = new Writer();
    writer.#instance = instance;
    let first = 0;
    const described = Object.entries(volumes);
    for (const [name, volume] of described) {
      const encoder = await VolumeEncoder.create(module, volume, {...options, firstTexture: first});
      writer.#encoders.set(name, encoder);
      first += encoder.textures.length;
    }
    const bounds = (place) => (Array.isArray(options.maxError) ? options.maxError[place] : options.maxError) ?? 0;
    writer.#handle = instance.with((memory) => {
      const container = instance.made('container_create', []);
      const note = (of, index, pairs = {}) => Object.entries(pairs).forEach(([name, value]) => instance.check(
          'container_add_metadata', [container, of, index, memory.text(name), memory.text(value)], {what: name}));
      note(METADATA_CONTAINER, 0, metadata);
      instance.check('container_set_scene', [container, memory.text(scene), 0n]);
      let texture = 0;
      described.forEach(([name, volume], place) => {
        instance.check('container_add_volume', [container, memory.text(name), createVolume(instance, volume)],
            {what: name});
        note(METADATA_VOLUME, place, volume.metadata);
        const textures = texturesOf(instance, volume);
        if (volume.geometry) {
          const {grid = textures[0].grid, ...rest} = volume.geometry;
          instance.check('container_set_geometry',
              [container, place, memory.struct(geometryStruct, {grid, spacing: [1, 1, 1], ...rest})]);
        }
        const notes = (volume.groups ?? [volume]).flatMap((group) => group.textures);
        textures.forEach((_, i) => {
          note(METADATA_TEXTURE, texture, notes[i].metadata);
          instance.check('container_set_largest_error', [container, texture++, bounds(i)]);
        });
      });
      return instance.made('writer_create', [0, container]);
    });
    return writer;
  }

  /**
   * Encodes the textures of volumes as a frame: {room: {color: array}}, or {color: array} of the only
   * volume. Frames do not decrease.
   */
  add(frame, volumes, blocks = 'changed') {
    this.#go();
    frameNumber(frame);  // before an encoder goes on
    const [first, ...others] = this.#encoders.keys();
    const bare = others.length === 0 && !isTextures(volumes[first]);
    const all = bare ? {[first]: volumes} : volumes;
    for (const [name, textures] of Object.entries(all)) {
      const encoder = this.#encoders.get(name);
      if (!encoder) throw new RangeError(`there is no volume "${name}": ${[...this.#encoders.keys()].join(', ')} are`);
      try {
        encoder.encode(textures, blocks).forEach((packet) => this.addPacket(frame, packet));
      } catch (error) {
        encoder.requestKeyframe();  // the file may lack what the encoder went on from
        throw error;
      }
    }
  }

  /** Adds a packet that another encoder made; its texture is the one that the packet names. */
  addPacket(frame, packet) {
    this.#go();
    this.#instance.with((memory) => this.#instance.check('writer_add',
        [this.#handle, frameNumber(frame), memory.put(packet), bytesOf(packet).length], {what: `frame ${frame}`}));
  }

  /** The bytes since the last call, for those that send the container while it grows. */
  take() {
    this.#go();
    this.#instance.check('writer_flush', [this.#handle]);
    return this.#bytes();
  }

  /** Ends the container: its bytes, or those since take(). */
  finish() {
    this.#go();
    this.#instance.check('writer_finish', [this.#handle]);
    this.#ended = true;
    return this.#bytes();
  }

  #go() {
    if (this.#ended) {
      throw new GicodecError(OUT_OF_ORDER, 'finish() ended this container: create another Writer');
    }
  }

  #bytes() {
    const bytes = this.#instance.borrowed(Uint8Array, 'writer_bytes', this.#handle);
    this.#instance.check('writer_take', [this.#handle]);
    return bytes;
  }
}
