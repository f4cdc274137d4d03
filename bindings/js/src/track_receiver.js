// Receiver of tracks, without a transport: stands between messages of tracks and a Client.
import {checkOptions} from './error.js';
import {bytesOf} from './instance.js';
import {
  CORRUPT, UNKNOWN_REGION, track as trackStruct, trackName, trackObject, trackReceiverOptions, trackReceiverState,
} from './interface.js';

/** Takes messages of a publisher and of a Client of shared delivery, for which it is the server. */
export class TrackReceiver {
  #instance;
  #handle;

  /** @internal */
  static async create(module, options = {}) {
    checkOptions(options, ['reach', 'subscribedOnly', 'maxTracks', 'maxWaitingBytes']);
    const {reach = 0} = options;
    if (!(reach >= 0 && reach < Infinity)) throw new RangeError(`reach is a distance, 0 or more, not ${reach}`);
    const instance = await module.create();
    const receiver = new TrackReceiver();
    receiver.#instance = instance;
    receiver.#handle = instance.with((memory) => instance.made(
        'track_receiver_create', [memory.struct(trackReceiverOptions, options)], {what: 'options of tracks'}));
    return receiver;
  }

  /** Takes a message of the publisher. Missing, repeated, reordered and damaged ones are no errors. */
  receive(message) {
    this.#take('track_receiver_receive', message, {what: 'what is published', also: [CORRUPT]});
  }

  /** Takes a message of the client. */
  take(message) {
    this.#take('track_receiver_take', message, {what: 'a message of the client'});
  }

  #take(name, message, options) {
    this.#instance.with((memory) => this.#instance.check(
        name, [this.#handle, memory.put(message), bytesOf(message).length], options));
  }

  /** The messages for the client. Call it when no more can be received without waiting. */
  messages() {
    return this.#instance.all('track_receiver_message', this.#handle);
  }

  /** The tracks to receive updates of, the nearest first: {volume, texture, region}. */
  get wanted() {
    const instance = this.#instance;
    return instance.with((memory) => {
      const first = memory.room(4), count = memory.room(4);
      instance.check('track_receiver_wanted', [this.#handle, first, count]);
      return instance.list(trackStruct, instance.word(first), instance.word(count));
    });
  }

  /** What to fetch, once: {list, objects}, of which each is {track, number}. Subscribe to `wanted` before. */
  requests() {
    const instance = this.#instance;
    return instance.with((memory) => {
      const list = memory.room(4), first = memory.room(4), count = memory.room(4);
      instance.check('track_receiver_requests', [this.#handle, list, first, count]);
      return {list: instance.word(list) !== 0,
              objects: instance.list(trackObject, instance.word(first), instance.word(count))};
    });
  }

  /** What identifies a track in subjects: {volume, texture, place}; null if there is none. */
  name(track) {
    const instance = this.#instance;
    return instance.with((memory) => {
      const out = memory.struct(trackName);
      const status = instance.check('track_receiver_name', [this.#handle, memory.struct(trackStruct, track), out],
                                    {also: [UNKNOWN_REGION]});
      if (status === UNKNOWN_REGION) return null;
      const {volume, texture, place} = instance.read(trackName, out);
      return {volume: instance.text(volume), texture: instance.text(texture), place};
    });
  }

  /** wantsHello: give it client.hello(); complete, wantedChanges, ticks, objects, repeated, earlier, damaged, requests. */
  get state() {
    const instance = this.#instance;
    return instance.with((memory) => {
      const out = memory.struct(trackReceiverState);
      instance.check('track_receiver_get_state', [this.#handle, out]);
      const {wantsHello, complete, ...rest} = instance.read(trackReceiverState, out);
      return {...rest, wantsHello: wantsHello !== 0, complete: complete !== 0};
    });
  }
}
