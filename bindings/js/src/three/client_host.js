// A client and its connection, in a worker or on the page's thread: tells of updates as blocks, one after
// the other, so that a page that is slow gets fewer and larger ones.
import {Client} from '../client.js';
import {Connection} from '../connection.js';
import {Instance, bytesOf} from '../instance.js';
import {TrackConnection} from '../track_connection.js';
import {TrackReceiver} from '../track_receiver.js';
import {Tiles} from './tilings.js';

export class ClientHost {
  #post;
  #connection = null;
  #client;
  #sent = 0;       // the serial of what the page has
  #busy = false;   // it has not answered yet
  #known = '';     // the volumes that it knows
  #tiles = new Map();  // of their textures, by id
  #decodeMs = 0;
  #closed = false;
  #bus = {};       // what takes messages that come over the page's connection

  /** `post(message, transfer)` sends to the page. */
  constructor(post) {
    this.#post = post;
  }

  /** Takes a message of the page's: the first one connects. */
  async take(message) {
    try {
      switch (message.type) {
        case 'connect': return await this.#connect(message);
        case 'view': return this.#view(message);
        case 'drawn': return this.#drawn();
        case 'bus': return this.#bus[message.call]?.(message.value);
        case 'close':
          this.#closed = true;
          return this.#connection?.close();
      }
    } catch (error) {
      this.#fail(error);
    }
  }

  async #connect({module, url, options: {everything, timeout, prefix, reach, ...options}}) {
    const modules = {create: () => Instance.create(module)};
    const tracks = url === undefined;  // by a connection of the page's
    this.#client = await Client.create(modules, tracks ? {...options, delivery: 'shared'} : options);
    const receiver = tracks && await TrackReceiver.create(modules, {reach});
    if (this.#closed) return;
    const receive = this.#client.receive.bind(this.#client);
    this.#client.receive = (message) => {
      const began = performance.now();
      try {
        return receive(message);
      } finally {
        this.#decodeMs += performance.now() - began;
      }
    };
    const on = {onUpdate: () => this.#update(), onLost: (wait, why) => this.#post({type: 'lost', wait, why})};
    this.#connection = tracks
      ? new TrackConnection(this.#client, receiver, (bus) => this.#busOfPage(bus), {prefix, timeout, ...on})
      : new Connection(this.#client, url, {timeout, everything, ...on});
    this.#connection.closed.then((reason) => this.#post({type: 'closed', reason}), (error) => this.#fail(error));
  }

  /** The page's NatsBus. */
  #busOfPage(bus) {
    this.#bus = bus;
    const call = (name) => (value) => this.#post({type: 'bus', call: name, value});
    return {subscribe: call('subscribe'), unsubscribe: call('unsubscribe'), request: call('request'), close: call('close')};
  }

  #view({viewpoint}) {
    if (!this.#client?.state.connected) return;
    this.#client.setViewpoint(viewpoint);
    this.#connection.send();
  }

  #drawn() {
    this.#busy = false;
    if (this.#client.state.serial !== this.#sent) this.#update();
  }

  #fail({message, name, status}) {
    this.#post({type: 'failed', error: {message, name, status}});
  }

  #update() {
    const {volumes, state} = this.#client;
    if (this.#busy || !state.consistent) return;
    const known = volumes.map(({id}) => id).join();
    if (known !== this.#known) {
      this.#known = known;
      this.#sent = 0;
      this.#tiles = new Map(volumes.map(({id, textures}) => [id, textures.map((desc) => new Tiles(desc))]));
      this.#post({type: 'volumes', volumes: volumes.map(({id, name, kind, geometry, textures}) => ({
        id, name, kind, geometry, textures: textures.map(({ArrayType, ...desc}) => ({...desc, arrayType: ArrayType.name}))}))});
    }
    const parts = [], transfer = [];
    for (const volume of volumes) {
      volume.textures.forEach((_, texture) => {
        const tiles = this.#tiles.get(volume.id)[texture];
        const blocks = volume.changed(texture, this.#sent);
        if (blocks.length === 0) return;
        const all = bytesOf(volume.texels(texture));
        const pieces = [];
        for (const block of blocks) tiles.forRows(block, (first, end) => pieces.push([first, end]));
        const bytes = new Uint8Array(pieces.reduce((sum, [first, end]) => sum + end - first, 0));
        let at = 0;
        for (const [first, end] of pieces) {
          bytes.set(all.subarray(first, end), at);
          at += end - first;
        }
        parts.push({id: volume.id, texture, blocks, bytes});
        transfer.push(blocks.buffer, bytes.buffer);
      });
    }
    this.#sent = state.serial;
    this.#busy = true;
    this.#post({type: 'update', state, decodeMs: this.#decodeMs, geometries: volumes.map(({id, geometry}) => ({id, geometry})), parts},
               transfer);
    this.#decodeMs = 0;
  }
}
