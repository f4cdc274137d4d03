// An instance of a WebAssembly module of the library, with memory of its own, and what lies in it.
// Views of its memory are made anew after each call, which may move it.
import {GicodecError, quoted} from './error.js';
import {BACKEND_MISSING, LIMIT_EXCEEDED, OK, OUT_OF_MEMORY, STATUS_NAMES, view} from './interface.js';

/** Limits that large scenes meet first. */
const MEMORY = ['maxTotalBytes', 'maxTextureBytes', 'maxWorkBytes'];
const decoder = new TextDecoder();
const encoder = new TextEncoder();

export class Instance {
  #exports;
  #ended = null;

  /** @param {WebAssembly.Module} module */
  static async create(module) {
    const {exports} = await WebAssembly.instantiate(module, {});
    exports._initialize();
    return new Instance(exports);
  }

  constructor(exports) {
    this.#exports = exports;
  }

  /**
   * Calls gicodec_NAME and returns what it does. An instance without memory ends, alone: each later
   * call fails, too.
   */
  call(name, ...values) {
    return this.#run(`gicodec_${name}`, values.map((value) => (typeof value === 'object' ? Number(value) : value)));
  }

  #run(name, values) {
    if (this.#ended) throw this.#ended;
    try {
      return this.#exports[name](...values);
    } catch (cause) {
      if (!(cause instanceof WebAssembly.RuntimeError || cause instanceof RangeError)) throw cause;
      this.#ended = new GicodecError(
          OUT_OF_MEMORY, 'this object has ended, most likely because there is no more memory: drop ' +
          'it, and make a new one', {cause});
      throw this.#ended;
    }
  }

  /** The same for calls that return a status: throws if it is not ok, or one of `also`. */
  check(name, values, {what = '', also = []} = {}) {
    const status = this.call(name, ...values);
    if (status !== OK && !also.includes(status)) throw this.error(status, what);
    return status;
  }

  /** Throws an error that names the field if a "texture_desc" or "volume_desc" is not valid. */
  checkDesc(kind, at, what) {
    const status = this.call(`${kind}_check`, at);
    if (status === OK) return;
    const why = this.text(this.call(`${kind}_problem`, at));
    throw this.error(status, what, why);
  }

  /** The handle that check(name, [...values, &handle]) stores. */
  made(name, values, options) {
    return this.with((memory) => {
      const out = memory.room(4);
      this.check(name, [...values, out], options);
      return this.word(out);
    });
  }

  /** A copy of the array that check(name, [...values, &array, &count]) stores. */
  listed(Type, name, values, options) {
    return this.with((memory) => {
      const at = memory.room(4), count = memory.room(4);
      this.check(name, [...values, at, count], options);
      return this.word(count) === 0 ? new Type() : this.array(Type, this.word(at), this.word(count)).slice();
    });
  }

  error(status, what = '', why = '') {
    const meaning = this.text(this.call('status_text', status)) || STATUS_NAMES[status];
    const text = why ? `${meaning}: ${why}` : meaning;
    return new GicodecError(status, `${what ? `${what}: ` : ''}${text}${this.#cure(status)}`);
  }

  #cure(status) {
    if (status === BACKEND_MISSING) {
      return '; the package has native and raw: gicodec decode and gicodec encode make a file of these';
    }
    const limited = status === LIMIT_EXCEEDED && !this.#exports.gicodec_encoder_create;  // encoders have no limits
    return limited ? `; the option limits allows more: {${MEMORY.join(', ')}}, below 256 MiB a texture` : '';
  }

  /** A view that is valid until the next call. */
  bytes(at, size) {
    return new Uint8Array(this.#exports.memory.buffer, at, size);
  }

  /** The same of another type; `at` is aligned for it. */
  array(Type, at, count) {
    return new Type(this.#exports.memory.buffer, at, count);
  }

  /** Memory for the caller, until free(). */
  allocate(size) {
    const at = this.#run('malloc', [Math.max(size, 1)]) >>> 0;
    if (at === 0) throw this.error(OUT_OF_MEMORY, `${size} bytes`);
    return at;
  }

  free(at) {
    this.#run('free', [at]);
  }

  /**
   * Calls body(memory): memory.put(array), .text(string), .room(size), .struct(struct, values) and
   * .list(struct, rows) return addresses that are valid until body returns.
   */
  with(body) {
    const taken = [];
    const room = (size) => {
      const at = this.allocate(size);
      taken.push(at);
      return at;
    };
    const memory = {
      room,
      put: (array) => {
        const bytes = bytesOf(array);
        const at = room(bytes.length);
        this.bytes(at, bytes.length).set(bytes);
        return at;
      },
      text: (string) => memory.put(encoder.encode(`${checkText(`${string}`)}\0`)),
      struct: (struct, values = {}) => {
        const at = room(struct.size);
        this.write(struct, at, values);
        return at;
      },
      list: (struct, rows) => {
        const at = room(struct.size * rows.length);
        rows.forEach((row, i) => this.write(struct, at + i * struct.size, row));
        return at;
      },
    };
    try {
      return body(memory);
    } finally {
      if (!this.#ended) taken.forEach((at) => this.free(at));
    }
  }

  /**
   * Calls body(address of a view) to write a texture of `size` bytes into an array of the caller's, which
   * keeps what the library leaves alone.
   */
  into(out, size, body) {
    const bytes = bytesOf(out).subarray(0, size);
    return this.with((memory) => {
      const at = memory.put(bytes);
      body(memory.struct(view, {bytes: at, size}));
      bytes.set(this.bytes(at, size));
      return out;
    });
  }

  /** Fills a struct: what `values` lacks is 0. */
  write(struct, at, values) {
    this.bytes(at, struct.size).fill(0);
    const all = struct.fields.structSize ? {structSize: struct.size, ...values} : values;
    const data = new DataView(this.#exports.memory.buffer);
    for (const [name, value] of Object.entries(all)) {
      if (value === undefined || value === null) continue;
      const field = Object.hasOwn(struct.fields, name) && struct.fields[name];
      if (!field) {
        throw new TypeError(`there is no ${name}: there are ${Object.keys(struct.fields).join(', ')}`);
      }
      const [offset, type, count] = field;
      const list = count > 1 ? [...value] : [value];
      if (list.length > count) throw new RangeError(`${name} has at most ${count} entries`);
      list.forEach((one, i) => {
        if (typeof type === 'object') return this.write(type, at + offset + i * type.size, one);
        const [, kind, bits] = type.match(/(\D+)(\d+)/);
        const number = Number(one);
        if (kind !== 'Float') {
          const least = kind === 'Int' ? -(2 ** (bits - 1)) : 0, end = least + 2 ** bits;
          if (!Number.isInteger(number) || number < least || number >= end) {
            throw new RangeError(`${name} is a whole number from ${least} to below ${end}, not ${one}`);
          }
        }
        data[`set${type}`](at + offset + i * bits / 8, kind === 'BigUint' ? BigInt(one) : number, true);
      });
    }
  }

  /** The fields of a struct; 64-bit numbers as Number. */
  read(struct, at) {
    const data = new DataView(this.#exports.memory.buffer);
    const found = {};
    for (const [name, [offset, type, count]] of Object.entries(struct.fields)) {
      if (name === 'structSize') continue;
      const one = (i) => {
        if (typeof type === 'object') return this.read(type, at + offset + i * type.size);
        const size = Number(type.match(/\d+/)[0]) / 8;
        return Number(data[`get${type}`](at + offset + i * size, true));
      };
      found[name] = count === 1 ? one(0) : Array.from({length: count}, (_, i) => one(i));
    }
    return found;
  }

  /** Text of the library's; "" for null. */
  text(at) {
    at >>>= 0;
    if (at === 0) return '';
    const bytes = new Uint8Array(this.#exports.memory.buffer, at);
    return decoder.decode(bytes.subarray(0, bytes.indexOf(0)));
  }

  /** The structs that lie from an address on. */
  list(struct, at, count) {
    return Array.from({length: count}, (_, i) => this.read(struct, at + i * struct.size));
  }

  /** What call(name, ...values, &size) gives until there is no more, copies. */
  all(name, ...values) {
    const found = [];
    for (;;) {
      const one = this.borrowed(Uint8Array, name, ...values);
      if (one.length === 0) return found;
      found.push(one);
    }
  }

  /** A copy of what call(name, ...values, &count) points to. */
  borrowed(Type, name, ...values) {
    return this.with((memory) => {
      const count = memory.room(4);
      const at = this.call(name, ...values, count) >>> 0;
      return at === 0 ? new Type() : this.array(Type, at, this.word(count)).slice();
    });
  }

  /** What call(name, ...values, out, capacity, &size) fills, a copy. */
  filled(name, ...values) {
    return this.with((memory) => {
      const size = memory.room(4);
      const status = this.call(name, ...values, 0, 0, size);
      if (this.word(size) === 0) throw this.error(status);
      const room = memory.room(this.word(size));
      this.check(name, [...values, room, this.word(size), size]);
      return this.bytes(room, this.word(size)).slice();
    });
  }

  /** The JSON text that such a call fills, as an object with names of JavaScript. */
  json(name, ...values) {
    const bytes = this.filled(name, ...values);
    return camelKeys(JSON.parse(decoder.decode(bytes.subarray(0, -1))));
  }

  word(at) {
    return new DataView(this.#exports.memory.buffer).getUint32(at, true);
  }
}

/** Throws for what UTF-8 or the library's texts, which end at a zero, cannot hold. */
function checkText(string) {
  if (/\0|[\uD800-\uDBFF](?![\uDC00-\uDFFF])|(?<![\uD800-\uDBFF])[\uDC00-\uDFFF]/.test(string)) {
    throw new TypeError(`${quoted(string)} holds a zero or half a character`);
  }
  return string;
}

/** A frame's number as the library takes it. */
export function frameNumber(frame) {
  if (!Number.isSafeInteger(frame) || frame < 0) {
    throw new RangeError(`a frame has a number from 0 on, not ${frame}`);
  }
  return BigInt(frame);
}

/** The bytes of an ArrayBuffer or a view of one, without a copy. */
export function bytesOf(array) {
  if (array instanceof Uint8Array) return array;
  if (ArrayBuffer.isView(array)) return new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
  if (array instanceof ArrayBuffer ||
      (typeof SharedArrayBuffer !== 'undefined' && array instanceof SharedArrayBuffer)) {
    return new Uint8Array(array);
  }
  throw new TypeError('expected an ArrayBuffer, a typed array or a DataView');
}

const camel = (key) => key.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

function camelKeys(value) {
  if (Array.isArray(value)) return value.map(camelKeys);
  if (value === null || typeof value !== 'object') return value;
  return Object.fromEntries(Object.entries(value).map(([key, one]) => [camel(key), camelKeys(one)]));
}
