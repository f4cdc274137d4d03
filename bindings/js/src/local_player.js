// A player on the thread that it is called on: the page's, or a worker's.
import {complete, placeOf, readTexture} from './description.js';
import {GicodecError, quoted} from './error.js';
import {bytesOf, frameNumber} from './instance.js';
import {
  END, OK, OUT_OF_MEMORY, TRUNCATED, UNKNOWN_KIND, UNSUPPORTED_VERSION,
  limits as limitsStruct, playerOptions,
} from './interface.js';

/** Bytes from which on those of a container that was read by ranges are dropped. */
const MOST_HELD = 64 << 20;

export class LocalPlayer {
  #instance;
  #player = 0;
  #arrived = false;  // all bytes have
  #played = false;
  #growing = false;  // bytes that it lacks may come
  #selected = null;  // the textures that are played; null: all
  #head = [];  // the first bytes, which name the version
  #size = null;  // of a container of which put() brings what is asked for
  #whole = false;  // all of it was asked for
  #follow = false;  // more may be appended to it

  constructor(instance) {
    this.#instance = instance;
  }

  /** Takes bytes of the container, in order. */
  append(chunk) {
    const bytes = bytesOf(chunk);
    if (bytes.length === 0) return;
    const at = this.#instance.call('source_grow', bytes.length) >>> 0;
    if (at === 0) throw this.#instance.error(OUT_OF_MEMORY, 'the bytes of the container');
    this.#instance.bytes(at, bytes.length).set(bytes);
    if (this.#head.length < 10) this.#head.push(...bytes.subarray(0, 10 - this.#head.length));
  }

  /** Says that the container has that many bytes. Calls answer {missing: [{offset, size}, …]} for those to put(). */
  begin(size) {
    this.#size = BigInt(size);
    this.#arrived = true;
  }

  /** Takes bytes of such a container. */
  put(offset, chunk) {
    const bytes = bytesOf(chunk);
    const at = this.#instance.call('ranges_room', BigInt(offset), bytes.length) >>> 0;
    if (at === 0) throw this.#instance.error(OUT_OF_MEMORY, 'bytes of the container');
    this.#instance.bytes(at, bytes.length).set(bytes);
    if (offset === 0) this.#head = [...bytes.subarray(0, 10)];
  }

  /** What body() returns or throws, unless it lacked bytes. */
  #ranged(body) {
    if (this.#size === null) return body();
    let result, failure = null;
    try {
      result = body();
    } catch (error) {
      failure = error;
    }
    const missing = Array.from(this.#instance.borrowed(BigUint64Array, 'ranges_missing'), Number);
    if (missing.length > 0) {
      return {missing: missing.flatMap((offset, i) => (i % 2 === 0 ? [{offset, size: missing[i + 1]}] : []))};
    }
    if (failure) throw failure;
    return result;
  }

  /** Says that these were all. */
  finish() {
    this.#arrived = true;
    if (this.#player) this.#grow(false);
  }

  /** Opens what has arrived; null: more bytes are needed. Returns what the container holds. */
  open(options) {
    // A player that lacks bytes is open where they are of the index alone.
    if (this.#player) this.#instance.call('player_destroy', this.#player);
    this.#player = 0;
    const container = this.#ranged(() => this.#open(options));
    return this.#size === null || container.missing ? container : this.#indexed(container);
  }

  /** The container, unless it has no index to read parts by: then it is read whole. */
  #indexed(container) {
    if (this.#whole || this.#instance.call('player_seekable', this.#player)) return container;
    this.#whole = true;
    return {missing: [{offset: 0, size: Number(this.#size)}]};
  }

  #open({limits, textures, box, follow = false} = {}) {
    const instance = this.#instance;
    const status = instance.with((memory) => {
      const options = memory.struct(playerOptions, {limits: limits && memory.struct(limitsStruct, limits)});
      const out = memory.room(4);
      const source = this.#size === null ? instance.call('source_arrived') : instance.call('ranges_source', this.#size);
      const got = instance.call('player_open', source, options, out);
      this.#player = instance.word(out);
      return got;
    });
    if (status === TRUNCATED && !this.#arrived) return null;
    if (status === UNSUPPORTED_VERSION) throw this.#unknownVersion();
    if (status !== OK) throw instance.error(status, 'the container');
    this.#grow(this.#size !== null || !this.#arrived);
    const container = this.#container();
    this.textures = container.textures;
    this.#follow = follow;
    if (textures) this.#select(textures);
    if (box) this.#selectBox(box, container);
    return container;
  }

  #unknownVersion() {
    const instance = this.#instance;
    return instance.with((memory) => {
      const [major, minor, readable] = [0, 0, 0].map(() => memory.room(4));
      instance.check('container_version', [memory.put(Uint8Array.from(this.#head)), 10, major, minor, readable]);
      const version = instance.text(instance.call('version_text'));
      return new GicodecError(UNSUPPORTED_VERSION, 'the container has version ' +
        `${instance.word(major)}.${instance.word(minor)}, and gicodec ${version} reads version ` +
        `${instance.word(readable)}: take a newer gicodec`);
    });
  }

  #container() {
    const instance = this.#instance;
    const container = instance.call('player_container', this.#player);
    const {scene, metadata, volumes, textures} = instance.json('container_json', container);
    const named = (pairs) => Object.fromEntries(pairs);
    return {
      scene: scene.name, metadata: named(metadata),
      volumes: volumes.map((one) => ({...one, metadata: named(one.metadata)})),
      textures: textures.map((one) => {
        const known = one.grid !== undefined;  // of a kind that the library knows
        const desc = known ? complete(instance, one) : {};
        return {...desc, name: one.name, volume: one.volume, largestError: one.largestError ?? Infinity,
                metadata: named(one.metadata)};
      }),
    };
  }

  #select(textures) {
    if (!Array.isArray(textures)) throw new TypeError('textures is a list of names or numbers');
    const places = textures.map((one) => placeOf(this.textures, one));
    this.#instance.with((memory) => this.#instance.check(
        'player_select', [this.#player, memory.put(new Uint32Array(places)), places.length]));
    this.#selected = new Set(places);
  }

  #selectBox({volume = 0, first, last}, {volumes}) {
    const place = typeof volume === 'string' ? volumes.findIndex(({name}) => name === volume) : volume;
    if (!volumes[place]) throw new RangeError(`there is no volume ${quoted(volume)}`);
    for (const corner of [first, last]) {
      if (!Array.isArray(corner) || corner.length !== 3) throw new TypeError('a box has first and last, each [x, y, z] in blocks');
    }
    this.#instance.with((memory) => this.#instance.check(
        'player_select_box', [this.#player, place, ...[first, last].map((corner) => memory.put(new Uint32Array(corner)))]));
  }

  /** Says that the container has that many bytes now. */
  grow(size) {
    this.#size = BigInt(size);
    this.#instance.call('ranges_grow', this.#size);
  }

  /** Applies the next frame and returns its number; null at the end, undefined: more bytes needed. */
  next() {
    let frame = this.#ranged(() => this.#next());
    if (this.#size === null) return frame;
    if (frame === undefined && !this.#follow) {  // nothing is missing: the file was cut off here
      this.#grow(false);
      frame = this.#ranged(() => this.#next());
    }
    if (!frame?.missing) this.#instance.call('ranges_trim', MOST_HELD);
    return frame;
  }

  /** Says whether a frame may lack bytes that come later. */
  #grow(growing) {
    this.#growing = growing;
    this.#instance.check('player_set_growing', [this.#player, growing ? 1 : 0]);
  }

  #next() {
    const status = this.#instance.call('player_next', this.#player);
    if (status === END) return null;
    if (status === TRUNCATED && this.#growing) return undefined;
    if (status !== OK) throw this.#instance.error(status, this.#played ? `behind frame ${this.frame()}` : 'the first frame');
    this.#played = true;
    return this.frame();
  }

  /** The number of the last frame. */
  frame() {
    return Number(this.#instance.call('player_frame', this.#player));
  }

  seek(frame) {
    return this.#ranged(() => {
      this.#instance.check('player_seek', [this.#player, frameNumber(frame)], {what: `frame ${frame}`});
    });
  }

  /** The frames that can be sought: those that have arrived. */
  frames() {
    return this.#ranged(() => Array.from(this.#instance.listed(
        BigUint64Array, 'player_frames', [this.#player], {what: 'the index of the frames'}), Number));
  }

  /** A texture as of this frame, guard bands included: a typed array, `into` if given. */
  read(texture, into) {
    const {desc, place} = this.#texture(texture);
    return readTexture(this.#instance, desc, into, (at) =>
      this.#instance.check('player_read', [this.#player, place, at]));
  }

  #texture(texture) {
    const place = placeOf(this.textures, texture);
    const desc = this.textures[place];
    if (desc.grid === undefined) {
      throw new GicodecError(UNKNOWN_KIND, `${quoted(desc.name)} is of a kind that this version does not know`);
    }
    if (this.#selected && !this.#selected.has(place)) {
      throw new RangeError(`${quoted(desc.name)} is not among the textures that open() was told to play`);
    }
    if (!this.#played) throw new RangeError('nothing is played yet: call next() before');
    return {desc, place};
  }

  /** The blocks of a texture that the last frame may have changed, ascending; all after a seek. */
  changed(texture) {
    const {place} = this.#texture(texture);
    return this.#instance.borrowed(Uint32Array, 'player_changed', this.#player, place);
  }
}
