// A client over tracks, which any number of viewers receive from a broker.
import {Subjects} from './nats.js';

const SILENCE = 5000;  // milliseconds without a tick after which the user is told

/** Follows a publisher: calls onUpdate(client) after what changed what the client holds. */
export class TrackConnection {
  #receiver;
  #bus;
  #subjects;
  #options;
  #followed = new Map();  // tracks by the subject of their updates
  #changes = -1;
  #flushes = false;
  #seen = {ticks: 0, earlier: 0};
  #silence = 0;  // a timer
  #ended = false;
  #end;
  #abort;

  /** `makeBus({take, lost, failed})` gives {subscribe, unsubscribe, request, close}, see NatsBus. */
  constructor(client, receiver, makeBus, {prefix = 'gicodec', ...options}) {
    this.client = client;
    this.#receiver = receiver;
    this.#subjects = new Subjects(prefix);
    this.#options = options;
    /** Resolves once the session has ended; rejects if it cannot go on. */
    this.closed = new Promise((resolve, reject) => (this.#end = {resolve, reject}));
    this.closed.catch(() => {});  // unless somebody waits for it, it may fail unheard
    this.#abort = () => this.#fail(options.signal.reason);
    options.signal?.addEventListener('abort', this.#abort, {once: true});
    this.#bus = makeBus({
      take: (message) => this.#guard(() => { this.#receiver.receive(message); this.#wake(); }),
      lost: (why) => this.#ended || options.onLost?.(0, why),
      failed: (error) => this.#fail(error),
    });
    this.#guard(() => {
      for (const subject of [this.#subjects.list, this.#subjects.tick]) this.#bus.subscribe(subject);
      receiver.take(client.hello());
      this.#fetch();
      this.#listen();
    });
  }

  /** Tells why there is nothing new. */
  #listen() {
    const silence = this.#options.timeout ?? SILENCE;
    clearTimeout(this.#silence);
    if (silence === 0) return;
    this.#silence = setTimeout(() => {
      const {ticks, earlier} = this.#receiver.state;
      const why = ticks === 0 ? `nothing is published under ${this.#subjects.prefix}: gi-server --nats with that --nats-prefix does`
        : earlier !== this.#seen.earlier ? 'what is published now is of an earlier epoch, and ignored: the clock of its machine is behind'
        : `nothing was published for ${silence / 1000} s; the last state stays`;
      this.#options.onLost?.(0, why);
    }, silence);
  }

  /** All messages that come at once make one update. */
  #wake() {
    if (this.#flushes) return;
    this.#flushes = true;
    setTimeout(() => this.#guard(() => this.#flush()));
  }

  #flush() {
    this.#flushes = false;
    const {client} = this, before = client.state.serial;
    for (let messages; (messages = this.#receiver.messages()).length > 0;) {
      for (const message of messages) client.receive(message);
      this.#answer();
    }
    if (this.#receiver.state.wantsHello) {
      this.#receiver.take(client.hello());
      this.#wake();
    }
    this.#follow();
    this.#fetch();
    const {ticks, earlier} = this.#receiver.state;
    if (ticks !== this.#seen.ticks) {
      this.#seen = {ticks, earlier};
      this.#listen();
    }
    const {serial, consistent} = client.state;
    if (serial !== before && consistent) this.#options.onUpdate?.(client);
  }

  #answer() {
    for (const message of this.client.messages()) this.#receiver.take(message);
  }

  /** Subscribes to the updates of wanted tracks, and to no others. */
  #follow() {
    const {wantedChanges} = this.#receiver.state;
    // None is wanted before the client's first answer.
    if (wantedChanges === this.#changes && this.#followed.size > 0) return;
    const {wanted} = this.#receiver;
    this.#changes = wantedChanges;
    const subjects = new Map(wanted.map((track) => [this.#subjects.updates(this.#receiver.name(track)), track]));
    for (const subject of this.#followed.keys()) {
      if (!subjects.has(subject)) this.#bus.unsubscribe(subject);
    }
    for (const subject of subjects.keys()) {
      if (!this.#followed.has(subject)) this.#bus.subscribe(subject);
    }
    this.#followed = subjects;
  }

  #fetch() {
    const {list, objects} = this.#receiver.requests();
    const subjects = this.#subjects;
    if (list) {
      this.#bus.request(subjects.lastOf(subjects.list));
      this.#bus.request(subjects.lastOf(subjects.tick));
    }
    for (const {track, number} of objects) {
      const name = this.#receiver.name(track);
      if (!name) continue;
      const subject = subjects.object(name, number);
      this.#bus.request(number === 0 ? subjects.lastOf(subject) : subjects.updateOf(subject));
    }
  }

  /** Says what the client has to say, e.g. after client.setViewpoint(). */
  send() {
    if (this.#ended) return;
    this.#answer();
    this.#wake();
  }

  #guard(body) {
    if (this.#ended) return;
    try {
      body();
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Ends the session for good. */
  close() {
    if (this.#ended) return;
    this.#stop();
    this.#end.resolve('');
  }

  #fail(error) {
    this.#stop();
    this.#end.reject(error);
  }

  #stop() {
    if (this.#ended) return;
    this.#ended = true;
    clearTimeout(this.#silence);
    this.#options.signal?.removeEventListener('abort', this.#abort);
    this.#bus?.close();
  }
}
