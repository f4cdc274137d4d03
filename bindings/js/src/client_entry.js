// The entry "gicodec/client".
import * as client from './client.js';
import {Connection} from './connection.js';
import {Module} from './module.js';
import {NatsBus} from './nats.js';
import {TrackConnection} from './track_connection.js';
import * as tracks from './track_receiver.js';
import texts from 'gicodec:module/client';

const module = new Module('client', 'gicodec_client_hello', texts);

export {GicodecError} from './error.js';
export {simd, supported} from './module.js';

export const {ready} = module;
export const useModule = (source) => module.use(source);

export const Client = {create: (options) => client.Client.create(module, options)};
export const TrackReceiver = {create: (options) => tracks.TrackReceiver.create(module, options)};

/** The compiled module, for gicodec/three. @internal */
export const compiledClient = () => module.compiled();

/** Follows a server over WebSockets. */
export async function connect(url, {onUpdate, onLost, everything, timeout, signal, WebSocket, ...options} = {}) {
  signal?.throwIfAborted();
  const made = await client.Client.create(module, options);
  return new Connection(made, url, {onUpdate, onLost, everything, timeout, signal, WebSocket});
}

/** Follows a publisher of tracks over a connection of @nats-io/nats-core. */
export async function connectNats(nats, {prefix, reach, subscribedOnly, onUpdate, onLost, timeout, signal, ...options} = {}) {
  signal?.throwIfAborted();
  const made = await client.Client.create(module, {...options, delivery: 'shared'});
  const receiver = await TrackReceiver.create({reach, subscribedOnly});
  signal?.throwIfAborted();
  return new TrackConnection(made, receiver, (on) => new NatsBus(nats, on), {prefix, onUpdate, onLost, timeout, signal});
}
