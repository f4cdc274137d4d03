// Containers (.gic), from any source of bytes.
import {placeOf} from './description.js';
import {checkOptions, checkResponse} from './error.js';
import {bytesOf} from './instance.js';
import {place, useWorkers} from './workers.js';

/** Of a container that is read in parts: the least bytes to ask for, those between two ranges that are worth a request
 * less, and the most to ask for at once. */
const LEAST_PART = 16 << 10, GAP = 16 << 10, MOST_PART = 4 << 20;

/** Frees in workers what the page has dropped. */
const dropped = new FinalizationRegistry((host) => host.close());

/** Plays a container, in order or from any frame on. See Player.open(). */
export class Player {
  #host;
  #reader = null;   // of what has not arrived yet
  #owned = false;   // its chunks are nobody else's
  #ranges = null;   // {size, read} of a container that is read in parts
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
    checkOptions(options, ['limits', 'textures', 'box', 'follow', 'signal']);
    const {limits, textures, box, follow, signal} = options;
    signal?.throwIfAborted();
    const player = new Player(await place(module), signal);
    try {
      await player.#begin(await player.#abortable(Promise.resolve(source)));
      for (;;) {
        const container = await player.#ask('open', [{limits, textures, box, follow}]);
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

  /** Waits until the container has more bytes. */
  async #growth() {
    if (typeof this.#ranges.grow !== 'function') {
      throw new TypeError('follow: the source of the container does not say how it grows');
    }
    await this.#abortable(new Promise((resolve) => setTimeout(resolve, POLL)));
    const size = await this.#abortable(this.#ranges.grow());
    await this.#call('grow', [size]);
  }

  /** Calls a method until it has all bytes that it needs. */
  async #ask(method, values) {
    for (;;) {
      const result = await this.#call(method, values);
      if (!result?.missing) return result;
      await Promise.all(joinRanges(result.missing, this.#ranges.size).map((range) => this.#bring(range)));
    }
  }

  /** Reads bytes that were missing. */
  async #bring({offset, size}) {
    const bytes = bytesOf(await this.#abortable(this.#ranges.read(offset, size)));
    if (bytes.length !== size) {
      throw new TypeError(`the source of the container brings ${bytes.length} bytes from ${offset} on, not ${size}`);
    }
    await this.#call('put', [offset, bytes]);
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
        await (this.#ranges ? this.#growth() : this.#more());
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

/** Milliseconds between questions for what was appended. */
const POLL = 500;

/** What to ask for, to have these ranges. */
function joinRanges(ranges, total) {
  const joined = [];
  for (const {offset, size} of [...ranges].sort((a, b) => a.offset - b.offset)) {
    const end = Math.min(total, offset + Math.max(size, LEAST_PART));
    const last = joined.at(-1);
    if (last && offset <= last.end + GAP) last.end = Math.max(last.end, end);
    else joined.push({offset, end});
  }
  const parts = [];
  for (const {offset, end} of joined) {
    for (let at = offset; at < end; at += MOST_PART) parts.push({offset: at, size: Math.min(MOST_PART, end - at)});
  }
  return parts;
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
