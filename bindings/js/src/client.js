// The streaming protocol's client, without a transport: messages are bytes.
import {numberOf, placeOf, readTexture, texturesOf} from './description.js';
import {checkOptions} from './error.js';
import {bytesOf} from './instance.js';
import {
  END, OK, clientOptions, clientState, geometry as geometryStruct, limits as limitsStruct, viewpoint,
} from './interface.js';

const DELIVERIES = ['unicast', 'shared'];

/** A volume that a client holds. */
export class ClientVolume {
  #instance;
  #handle;

  constructor(instance, handle, number, id) {
    this.#instance = instance;
    this.#handle = handle;
    /** The server's number of it. */
    this.number = number;
    /** A number that no other volume of this client ever has. */
    this.id = id;
    this.name = instance.text(instance.call('client_volume_name', handle, number));
    const volume = instance.made('client_volume_desc', [handle, number]);
    const desc = instance.json('volume_desc_json', volume);
    instance.call('volume_desc_destroy', volume);
    this.kind = desc.kind;
    this.groups = desc.groups;
    this.textures = texturesOf(instance, desc);
  }

  get geometry() {
    const instance = this.#instance;
    return instance.with((memory) => {
      const out = memory.struct(geometryStruct);
      instance.check('client_geometry', [this.#handle, this.number, out]);
      return instance.read(geometryStruct, out);
    });
  }

  /**
   * A texture, guard bands included; with `after` just the blocks that changed after the update of that
   * serial, into an array of the caller's.
   */
  read(texture, into, after = 0) {
    const place = placeOf(this.textures, texture);
    return readTexture(this.#instance, this.textures[place], into, (at) =>
      this.#instance.check('client_read', [this.#handle, this.number, place, BigInt(after), at]));
  }

  /** The texels in the client's memory, not copied: valid until its next call. */
  texels(texture) {
    const place = placeOf(this.textures, texture);
    const {ArrayType} = this.textures[place];
    const instance = this.#instance;
    return instance.with((memory) => {
      const size = memory.room(4);
      const at = instance.call('client_texels', this.#handle, this.number, place, size) >>> 0;
      return instance.array(ArrayType, at, at === 0 ? 0 : instance.word(size) / ArrayType.BYTES_PER_ELEMENT);
    });
  }

  /** The blocks that were replaced after the update of that serial, ascending. */
  changed(texture, after = 0) {
    return this.#instance.listed(Uint32Array, 'client_changed', [
      this.#handle, this.number, placeOf(this.textures, texture), BigInt(after)]);
  }
}

/** Takes messages of a server, holds the textures of its volumes. */
export class Client {
  #instance;
  #handle;
  #volumes = new Map();

  /** @internal */
  static async create(module, options = {}) {
    checkOptions(options, ['budgetBlocks', 'budgetBytes', 'delivery', 'token', 'limits']);
    const {delivery = 'unicast', token = '', limits, ...budgets} = options;
    const instance = await module.create();
    const client = new Client();
    client.#instance = instance;
    client.#handle = instance.with((memory) => {
      const struct = memory.struct(clientOptions, {
        ...budgets, delivery: numberOf(DELIVERIES, delivery, 'delivery'), token: memory.text(token),
        limits: limits && memory.struct(limitsStruct, limits)});
      return instance.made('client_create', [struct]);
    });
    return client;
  }

  /** The message that opens a connection; after a lost one it asks to continue the session. */
  hello() {
    this.#instance.check('client_hello', [this.#handle]);
    return this.messages()[0];
  }

  /** Takes a message; false after the server's goodbye. After an error close the connection. */
  receive(message) {
    const instance = this.#instance;
    const status = instance.with((memory) => instance.check('client_receive',
        [this.#handle, memory.put(message), bytesOf(message).length], {what: 'a message', also: [END]}));
    return status === OK;
  }

  /** The messages to send, oldest first. */
  messages() {
    return this.#instance.all('client_message', this.#handle);
  }

  /** A camera in world units, by which a server may choose blocks. */
  setViewpoint({eye, target: at, up = [0, 1, 0], fovY = 60, aspect = 1, time = 0}) {
    this.#instance.with((memory) => this.#instance.check('client_set_viewpoint', [
      this.#handle, memory.struct(viewpoint, {eye, target: at, up, fovY, aspect, time})], {what: 'the viewpoint'}));
  }

  /** Chooses the blocks of a group, whatever the viewpoint: a truth value for each. */
  subscribe(volume, blocks, group = 0) {
    const mask = Uint8Array.from(blocks, Number);
    this.#instance.with((memory) => this.#instance.check(
        'client_subscribe', [this.#handle, volume, group, memory.put(mask), mask.length]));
  }

  /** Ends the session for good; send messages(), then close the connection. */
  disconnect() {
    this.#instance.check('client_disconnect', [this.#handle]);
  }

  /** What the client holds: connected, consistent, serial, update, time, volumes, reason, … */
  get state() {
    const instance = this.#instance;
    return instance.with((memory) => {
      const out = memory.struct(clientState);
      instance.check('client_get_state', [this.#handle, out]);
      const {connected, resumed, consistent, reason, ...rest} = instance.read(clientState, out);
      return {...rest, connected: connected !== 0, resumed: resumed !== 0, consistent: consistent !== 0,
              reason: instance.text(instance.call('reason_text', reason)), reasonNumber: reason};
    });
  }

  /** @returns {ClientVolume[]} */
  get volumes() {
    const instance = this.#instance;
    const found = instance.with((memory) => {
      const number = memory.room(4), id = memory.room(8);
      return Array.from({length: this.state.volumes}, (_, place) => {
        instance.check('client_volume', [this.#handle, place, number, id]);
        const key = Number(instance.array(BigUint64Array, id, 1)[0]);
        return this.#volumes.get(key) ?? new ClientVolume(instance, this.#handle, instance.word(number), key);
      });
    });
    this.#volumes = new Map(found.map((volume) => [volume.id, volume]));
    return found;
  }
}
