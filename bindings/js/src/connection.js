// A client over a WebSocket, which comes back after a lost connection.

const SHUTDOWN = 11;  // the reason of a server that ends: another one may begin
const SILENCE = 20000;  // milliseconds after which a connection counts as lost

/** Follows a server: calls onUpdate(client) after each message that changed what the client holds. */
export class Connection {
  #url;
  #options;
  #socket = null;
  #ended = false;
  #wait = 0;
  #timer = 0;
  #silence = 0;  // a timer
  #why = '';
  #end;
  #abort;

  constructor(client, url, options) {
    this.client = client;
    this.#url = url;
    this.#options = options;
    /** Resolves with the reason once the session has ended; rejects if it cannot go on. */
    this.closed = new Promise((resolve, reject) => (this.#end = {resolve, reject}));
    this.closed.catch(() => {});  // unless somebody waits for it, it may fail unheard
    this.#abort = () => this.#fail(options.signal.reason);
    options.signal?.addEventListener('abort', this.#abort, {once: true});
    if (options.signal?.aborted) this.#fail(options.signal.reason);
    else this.#connect();
  }

  #connect() {
    const Socket = this.#options.WebSocket ?? globalThis.WebSocket;
    if (typeof Socket !== 'function') {
      throw new TypeError('this engine has no WebSocket: give one, e.g. that of the package ws, ' +
                          'connect(url, {WebSocket})');
    }
    const socket = new Socket(this.#url, 'gicodec');
    this.#socket = socket;
    this.#why = '';
    socket.binaryType = 'arraybuffer';
    const is = () => socket === this.#socket;
    let opened = false;
    socket.onopen = () => is() && this.#guard(() => (opened = true, socket.send(this.client.hello())));
    socket.onmessage = ({data}) => is() && this.#guard(() => this.#take(data));
    socket.onclose = (event) => is() && this.#again(
        this.#why || event?.reason || (opened ? `the connection closed (${event?.code ?? 'no code'})`
          : 'there was no connection: nothing listens there, or the server lets no pages of this origin in (--allow-origin)'));
    socket.onerror = (event) => (this.#why = event?.message ?? '');  // close follows
    this.#listen();
  }

  /** Counts a connection as lost that brings nothing for long: no end notices a network that is gone. */
  #listen() {
    const silence = this.#options.timeout ?? SILENCE;
    clearTimeout(this.#silence);
    if (silence === 0) return;
    this.#silence = setTimeout(() => this.#again(`nothing came for ${silence / 1000} s`), silence);
  }

  #guard(body) {
    try {
      body();
    } catch (error) {
      this.#fail(error);
    }
  }

  #take(message) {
    const {client} = this;
    this.#listen();
    const before = client.state.serial;
    const goesOn = client.receive(message);
    if (goesOn && this.#options.everything !== false) this.#chooseAll();
    this.send();
    if (!goesOn) {
      const {reason, reasonNumber} = client.state;
      return reasonNumber === SHUTDOWN ? this.#again(reason) : this.#finish(reason);
    }
    const {serial, consistent} = client.state;
    if (serial === before) return;
    this.#wait = 0;  // what says nothing is not asked again at once
    if (consistent) this.#options.onUpdate?.(client);
  }

  #chosen = new Set();

  /** Without a viewpoint or a choice of blocks a server sends nothing. */
  #chooseAll() {
    for (const volume of this.client.volumes) {
      if (this.#chosen.has(volume.id)) continue;
      this.#chosen.add(volume.id);
      volume.groups.forEach((_, group) => {
        const [first] = volume.groups[group].textures;
        const desc = volume.textures.find((texture) => texture.name === first.name);
        this.client.subscribe(volume.number, new Uint8Array(desc.blocks).fill(1), group);
      });
    }
  }

  /** Sends what the client has to say, e.g. after client.setViewpoint(). */
  send() {
    if (this.#socket?.readyState !== 1) return;
    for (const message of this.client.messages()) this.#socket.send(message);
  }

  #again(why) {
    if (this.#ended) return;
    this.#leave();
    this.#wait = Math.min(Math.max(this.#wait * 2, 250), 8000);
    this.#options.onLost?.(this.#wait, why);
    if (this.#ended) return;  // it called close()
    this.#timer = setTimeout(() => this.#guard(() => this.#connect()), this.#wait);
  }

  /** Ends the session for good. */
  close() {
    if (this.#ended) return;
    this.#guard(() => {
      this.client.disconnect();
      this.send();
    });
    this.#finish('');
  }

  #finish(reason) {
    this.#stop();
    this.#end.resolve(reason);
  }

  #fail(error) {
    this.#stop();
    this.#end.reject(error);
  }

  #stop() {
    this.#ended = true;
    clearTimeout(this.#timer);
    this.#options.signal?.removeEventListener('abort', this.#abort);
    this.#leave();
  }

  /** Closes the connection, and hears no more of it. */
  #leave() {
    const socket = this.#socket;
    this.#socket = null;
    clearTimeout(this.#silence);
    socket?.close();
  }
}
