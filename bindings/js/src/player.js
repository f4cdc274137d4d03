// Containers (.gic), from any source of bytes.
import {placeOf} from './description.js';
import {checkOptions, checkResponse} from './error.js';
import {bytesOf} from './instance.js';
import {place, useWorkers} from './workers.js';

/** Bytes that are read at once of a container that is read in parts: at first, and at most. */
const FIRST_PART = 64 << 10, MOST_PART = 4 << 20;

/** Frees in workers what the page has dropped. */
const dropped = new FinalizationRegistry((host) => host.close());

/** Plays a container, in order or from any frame on. See Player.open(). */
export class Player {
  #host;
  #reader = null;   // of what has not arrived yet
  #owned = false;   // its chunks are nobody else's
  #ranges = null;   // {size, read} of a container that is read in parts
  #part = FIRST_PART;  // bytes to read at once
  #signal;
  #turn = Promise.resolve();
  #from = '';  // what the server says of its response

  constructor(host, signal) {
    this.#host = host;
    this.#signal = signal;
    dropped.register(this, host);
  }

  /** @internal */
  static async open(module, source, options = {}) {
    checkOptions(options, ['limits', 'textures', 'signal']);
    const {limits, textures, signal} = options;
    signal?.throwIfAborted();
    const player = new Player(await place(module), signal);
    try {
      await player.#begin(await player.#abortable(Promise.resolve(source)));
      for (;;) {
        const container = await player.#ask('open', [{limits, textures}]);
        if (container) return Object.assign(player, container);
        await player.#more();
      }
    } catch (error) {
      player.close();
      if (error.code === 'not_gicodec') error.message += player.#from;
      throw error;
    }
  }

  async #begin(given) {
    let source = given;
    if (typeof source === 'string' || source instanceof URL || source == null) {
      throw new TypeError(`a container is a Response, bytes, a Blob or a stream, not ${source}: ` +
                          'open(fetch(url)) takes it from the net, open(readFile(path)) from a disk');
    }
    if (typeof Response !== 'undefined' && source instanceof Response) {
      checkResponse(source);
      this.#owned = true;
      const type = source.headers.get('content-type');
      this.#from = `: ${source.url || 'the response'} brings ${type ?? 'bytes without a content type'}`;
      source = source.body ?? new Uint8Array();
    } else if (typeof Blob !== 'undefined' && source instanceof Blob) {
      this.#owned = true;
      source = source.stream();
    }
    if (typeof source.read === 'function' && Number.isSafeInteger(source.size)) {
      this.#ranges = source;
      await this.#call('begin', [source.size]);
    } else if (typeof source.getReader === 'function') {
      const reader = source.getReader();
      this.#reader = {next: () => reader.read(), cancel: (why) => reader.cancel(why)};
    } else if (typeof source[Symbol.asyncIterator] === 'function') {  // a stream of Node
      const iterator = source[Symbol.asyncIterator]();
      this.#reader = {next: () => iterator.next(), cancel: async () => iterator.return?.()};
    } else {
      await this.#call('append', [bytesOf(source)]);
      await this.#call('finish', []);
    }
  }

  /** Passes on what arrives next, small pieces that are there together, or that nothing does. */
  async #more() {
    let {done, value} = await this.#abortable(this.#ahead());
    const pieces = [];
    for (let size = 0; !done;) {
      pieces.push(bytesOf(value));
      size += pieces.at(-1).byteLength;
      const next = size < TOGETHER && await this.#abortable(Promise.race([this.#ahead(true), soon()]));
      if (!next) break;
      this.#next = null;
      ({done, value} = next);
    }
    if (pieces.length > 0) {
      const bytes = joined(pieces);
      const whole = (this.#owned || pieces.length > 1) && bytes.byteLength === bytes.buffer.byteLength;
      await this.#call('append', [bytes], whole ? [bytes.buffer] : []);
    }
    if (!done) return;
    this.#reader = null;
    await this.#call('finish', []);
  }

  /** Calls a method until it has all bytes that it needs. */
  async #ask(method, values) {
    for (this.#part = FIRST_PART;; this.#part = Math.min(2 * this.#part, MOST_PART)) {
      const result = await this.#call(method, values);
      if (!result?.missing) return result;
      await this.#bring(result.missing);
    }
  }

  /** Reads the bytes that were missing, and some around them. */
  async #bring({offset, size}) {
    const {size: total} = this.#ranges;
    const last = Math.min(total, offset + Math.max(size, this.#part));
    const first = last < total ? offset : Math.max(0, Math.min(offset, total - this.#part));
    const bytes = bytesOf(await this.#abortable(this.#ranges.read(first, last - first)));
    if (bytes.length !== last - first) {
      throw new TypeError(`the source of the container brings ${bytes.length} bytes from ${first} on, not ${last - first}`);
    }
    await this.#call('put', [first, bytes]);
  }

  #next = null;  // what was asked of the reader and has not come

  /** The reader's next piece; `keep`: the next call may wait for it again. */
  #ahead(keep = false) {
    if (!this.#reader) throw new TypeError('the player is closed');
    const next = this.#next ?? this.#reader.next();
    this.#next = keep ? next : null;
    if (keep) next.catch?.(() => {});
    return next;
  }

  #abortable(promise) {
    const signal = this.#signal;
    if (!signal) return promise;
    return new Promise((resolve, reject) => {
      const abort = () => {
        this.close(signal.reason);
        reject(signal.reason);
      };
      if (signal.aborted) return abort();
      signal.addEventListener('abort', abort, {once: true});
      promise.then(resolve, reject).finally(() => signal.removeEventListener('abort', abort));
    });
  }

  async #call(method, values, transfer) {
    if (!this.#host) throw this.#signal?.reason ?? new TypeError('the player is closed');
    return this.#abortable(this.#host.call(method, values, transfer));
  }

  /** Runs one call after the other, also where the caller does not wait. */
  #inTurn(body) {
    const turn = this.#turn.then(body);
    this.#turn = turn.catch(() => {});
    return turn;
  }

  /** Applies the next frame, once its bytes have arrived: its number, or null at the end. */
  next() {
    return this.#inTurn(async () => {
      for (;;) {
        const frame = await this.#ask('next', []);
        if (frame !== undefined) return frame;
        await this.#more();
      }
    });
  }

  /** All frames from here on, by number. After a break the player goes on where it is. */
  async* [Symbol.asyncIterator]() {
    for (let frame = await this.next(); frame !== null; frame = await this.next()) yield frame;
  }

  /** The next next() applies that frame. Of a stream: one that has arrived. */
  seek(frame) {
    return this.#inTurn(() => this.#ask('seek', [frame]));
  }

  /** The numbers of the frames that can be sought; of a stream: those that have arrived. */
  frames() {
    return this.#inTurn(() => this.#ask('frames', []));
  }

  /**
   * A texture as of the last frame, guard bands included. With `into` in that array, which a worker
   * returns as another one over the same memory: go on with what this resolves to.
   */
  read(texture, into) {
    return this.#inTurn(() => {
      const values = [placeOf(this.textures, texture), into];
      if (ArrayBuffer.isView(into) && into.buffer.byteLength === 0) {
        throw new TypeError('into was handed to a worker: go on with the array that read() resolved to');
      }
      const transfers = ArrayBuffer.isView(into) && into.buffer instanceof ArrayBuffer;
      return this.#call('read', values, transfers ? [into.buffer] : []);
    });
  }

  /** The blocks of a texture that the last frame may have changed, ascending; all after a seek. */
  changed(texture) {
    return this.#inTurn(() => this.#call('changed', [placeOf(this.textures, texture)]));
  }

  /** Ends it and frees its memory. */
  close(reason) {
    this.#reader?.cancel(reason).catch(() => {});
    this.#reader = null;
    this.#host?.close();
    this.#host = null;
  }
}

/** Bytes from which on pieces are passed on alone. */
const TOGETHER = 4096;
const soon = () => new Promise((resolve) => setTimeout(resolve, 0));

function joined(pieces) {
  if (pieces.length === 1) return pieces[0];
  const all = new Uint8Array(pieces.reduce((size, piece) => size + piece.byteLength, 0));
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.byteLength;
  }
  return all;
}

export {useWorkers};
