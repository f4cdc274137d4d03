// Tracks on NATS, by a connection of @nats-io/nats-core that the caller has made: names of subjects and of
// the streams that keep messages, and what a TrackConnection asks of a transport.

const TIMEOUT = 10000;  // milliseconds for an answer: what is missing is asked for again

/** A name as one token of a subject: bytes other than letters, digits, '-' and '_' become %XX. */
function token(name) {
  const bytes = new TextEncoder().encode(name);
  const one = (byte) => (/[\w-]/.test(String.fromCharCode(byte)) ? String.fromCharCode(byte)
    : `%${byte.toString(16).toUpperCase().padStart(2, '0')}`);
  return Array.from(bytes, one).join('') || '%';
}

/** Subjects of a publisher (docs/protocol.md, "Tracks"). */
export class Subjects {
  #stream;

  constructor(prefix) {
    if (!/^[\w-]+(\.[\w-]+)*$/.test(prefix) || prefix.length > 64) {
      throw new TypeError('prefix: expected letters, digits, - and _, with single dots between, at most 64 characters');
    }
    this.prefix = prefix;
    this.#stream = prefix.replaceAll('.', '~');
    this.list = `${prefix}.list`;
    this.tick = `${prefix}.tick`;
  }

  /** Of a track's snapshots, number 0, or of its other objects of a number. */
  object({volume, texture, place}, number) {
    const track = [this.prefix, token(volume), token(texture), ...place].join('.');
    return number === 0 ? track : `${track}.${number}`;
  }

  /** Of all of a track's objects that are no snapshots. */
  updates(name) {
    return `${this.object(name, 0)}.*`;
  }

  /** Requests for the last message of a subject: of the stream that keeps snapshots, and of that of updates. */
  lastOf(subject) {
    return `$JS.API.DIRECT.GET.${this.#stream}-last.${subject}`;
  }
  updateOf(subject) {
    return `$JS.API.DIRECT.GET.${this.#stream}-updates.${subject}`;
  }
}

/** A user of the servers' who lacks a right does not get it by waiting. */
const isRefused = (error) => /permission/i.test(`${error?.name} ${error?.message}`);

const closed = () => new Error('the connection to NATS was closed');

/** A connection to NATS as a TrackConnection needs it. */
export class NatsBus {
  #nats;
  #on;
  #subscriptions = new Map();
  #ended = false;

  /** `on`: take(bytes), lost(why), and failed(error) if it cannot go on. */
  constructor(nats, on) {
    this.#nats = nats;
    this.#on = on;
    this.#watch().catch((error) => this.#fail(error));
    nats.closed().then((error) => this.#fail(error ?? closed()));
  }

  async #watch() {
    let lost = false;  // it also tells of each try to connect again
    for await (const {type, server} of this.#nats.status()) {
      if (this.#ended) return;
      if (type === 'disconnect' && !lost) this.#on.lost(`the connection to ${server ?? 'NATS'} was lost`);
      if (type === 'disconnect' || type === 'reconnect') lost = type === 'disconnect';
    }
  }

  subscribe(subject) {
    if (this.#nats.isClosed()) return this.#fail(closed());
    const callback = (error, message) => (error ? this.#fail(error) : this.#take(message.data));
    this.#subscriptions.set(subject, this.#nats.subscribe(subject, {callback}));
  }

  unsubscribe(subject) {
    this.#subscriptions.get(subject)?.unsubscribe();
    this.#subscriptions.delete(subject);
  }

  /** Sends a request, whose answer is taken as a message. */
  request(subject) {
    this.#nats.request(subject, undefined, {timeout: TIMEOUT}).then(
        // What answers has its place in the stream; else there is none.
        ({data, headers}) => headers?.has('Nats-Sequence') && this.#take(data),
        (error) => isRefused(error) && this.#fail(error));
  }

  #take(bytes) {
    if (!this.#ended) this.#on.take(bytes);
  }

  #fail(error) {
    if (this.#ended) return;
    this.close();
    this.#on.failed(isRefused(error) ? new Error(
        `${error.message}; the user of this connection may not look at that prefix`, {cause: error}) : error);
  }

  /** Ends its subscriptions. The connection is its maker's, and stays. */
  close() {
    this.#ended = true;
    if (this.#nats.isClosed()) return;
    for (const subject of [...this.#subscriptions.keys()]) this.unsubscribe(subject);
  }
}
