import type {Bytes, Geometry, Kind, Limits, OwnBytes, Texels, Texture, TextureGroup} from './common.js';
export * from './common.js';

export interface Viewpoint {
  /** In world units. */
  eye: number[];
  target: number[];
  up?: number[];
  /** Degrees. */
  fovY?: number;
  /** Width over height. */
  aspect?: number;
  /** Of the client's picture, in seconds; 0: no clock of its own. */
  time?: number;
}

export interface ClientState {
  connected: boolean;
  /** The last hello continued a session. */
  resumed: boolean;
  /** The frame is complete. */
  consistent: boolean;
  epoch: number;
  /** Counts the updates applied. */
  serial: number;
  update: number;
  /** Of what the server shows, in seconds. */
  time: number;
  volumes: number;
  /** Of the server's goodbye. */
  reason: string;
  /** The same as the protocol's number, e.g. 11: the server ends. */
  reasonNumber: number;
  messages: number;
  bytes: number;
  packets: number;
  blocks: number;
  gaps: number;
}

/** A volume that a client holds. */
export interface ClientVolume {
  /** The server's number of it. */
  readonly number: number;
  /** A number that no other volume of this client ever has. */
  readonly id: number;
  readonly name: string;
  readonly kind: Kind;
  readonly groups: TextureGroup[];
  readonly textures: Texture[];
  readonly geometry: Geometry;
  /** A texture; with `after` just the blocks that changed after the update of that serial. */
  read(texture: string | number): Texels;
  read<T extends ArrayBufferView>(texture: string | number, into: T, after?: number): T;
  /** The texels in the client's memory, not copied: valid until its next call. */
  texels(texture: string | number): Texels;
  /** The blocks that were replaced after the update of that serial, ascending. */
  changed(texture: string | number, after?: number): Uint32Array;
}

export interface ClientOptions {
  delivery?: 'unicast' | 'shared';
  token?: string;
  /** Most blocks of an update; 0: no limit. */
  budgetBlocks?: number;
  budgetBytes?: number;
  limits?: Limits;
}

/** Takes messages of a server, holds the textures of its volumes. Has no transport: messages are bytes. */
export interface Client {
  /** The message that opens a connection; after a lost one it asks to continue the session. */
  hello(): OwnBytes;
  /** Takes a message; false after the server's goodbye. After an error close the connection. */
  receive(message: Bytes): boolean;
  /** The messages to send, oldest first. */
  messages(): OwnBytes[];
  setViewpoint(viewpoint: Viewpoint): void;
  /** Chooses the blocks of a group, whatever the viewpoint: a truth value for each. */
  subscribe(volume: number, blocks: Iterable<number | boolean>, group?: number): void;
  /** Ends the session for good; send messages(), then close the connection. */
  disconnect(): void;
  readonly state: ClientState;
  readonly volumes: ClientVolume[];
}
export const Client: {create(options?: ClientOptions): Promise<Client>};

export interface ConnectOptions extends ClientOptions {
  /** Called after each message that changed what the client holds. */
  onUpdate?(client: Client): void;
  /** Called when the connection was lost, with the milliseconds until the next try, and why. */
  onLost?(wait: number, why: string): void;
  /** Milliseconds without a message after which a connection counts as lost: 20,000; 0: none. */
  timeout?: number;
  /** False: ask for no blocks but those of client.subscribe() and client.setViewpoint(). */
  everything?: boolean;
  signal?: AbortSignal;
  /** In place of the global one, e.g. that of the package ws. */
  WebSocket?: new (url: string, protocol: string) => unknown;
}

/** A client over a WebSocket, which comes back after a lost connection. */
export interface Connection {
  readonly client: Client;
  /** Resolves with the reason once the session has ended; rejects if it cannot go on. */
  readonly closed: Promise<string>;
  /** Sends what the client has to say, e.g. after client.setViewpoint(). */
  send(): void;
  /** Ends the session for good. */
  close(): void;
}

/** Follows a server over WebSockets (gi-server --listen-web): wss://HOST:PORT. */
export function connect(url: string, options?: ConnectOptions): Promise<Connection>;

/** A region of a texture, which is received by itself. */
export interface Track {
  volume: number;
  texture: number;
  region: number;
}

export interface TrackReceiverOptions {
  /**
   * Distance from the viewpoint, in world units, up to which regions are received, the nearest first. Absent:
   * all of them, or those of client.subscribe().
   */
  reach?: number;
  /** True: nothing but the regions of client.subscribe(). */
  subscribedOnly?: boolean;
  maxTracks?: number;
  maxWaitingBytes?: number;
}

/**
 * Stands between messages of tracks (docs/protocol.md, "Tracks") and a Client of shared delivery, for which it
 * is the server. Has no transport.
 */
export interface TrackReceiver {
  /** Takes a message of the publisher. Missing, repeated, reordered and damaged ones are no errors. */
  receive(message: Bytes): void;
  /** Takes a message of the client: hello() and messages(). */
  take(message: Bytes): void;
  /** The messages for the client. Call it when no more can be received without waiting. */
  messages(): OwnBytes[];
  /** The tracks to receive updates of, the nearest first. */
  readonly wanted: Track[];
  /** What to fetch, once: the last list and tick, and objects; of number 0 a track's last snapshot. */
  requests(): {list: boolean; objects: {track: Track; number: number}[]};
  /** What identifies a track in subjects; null if there is none. */
  name(track: Track): {volume: string; texture: string; place: number[]} | null;
  readonly state: {
    /** A later publisher is there: take(client.hello()). */
    wantsHello: boolean;
    /** The client has all that is wanted as of the last tick. */
    complete: boolean;
    wantedChanges: number;
    ticks: number;
    objects: number;
    repeated: number;
    /** Messages of an earlier epoch, which are ignored. */
    earlier: number;
    damaged: number;
    requests: number;
  };
}
export const TrackReceiver: {create(options?: TrackReceiverOptions): Promise<TrackReceiver>};

/** What is used of a NatsConnection of @nats-io/nats-core. */
export interface NatsConnection {
  subscribe(subject: string, options: {callback(error: Error | null, message: {data: Uint8Array}): void}): {unsubscribe(): void};
  request(subject: string, payload: undefined, options: {timeout: number}): Promise<{data: Uint8Array; headers?: {has(name: string): boolean}}>;
  status(): AsyncIterable<{type: string; server?: string}>;
  closed(): Promise<void | Error>;
  isClosed(): boolean;
}

export interface NatsOptions extends Omit<ClientOptions, 'delivery' | 'token'> {
  /** That of gi-server --nats-prefix: "gicodec". */
  prefix?: string;
  /** See TrackReceiverOptions. */
  reach?: number;
  subscribedOnly?: boolean;
  /** Called after each update of what the client holds. */
  onUpdate?(client: Client): void;
  /**
   * Called when the connection was lost, which makes itself anew, and when nothing is published: the client keeps
   * the last state.
   */
  onLost?(wait: number, why: string): void;
  /** Milliseconds without an update after which onLost() is called: 5,000; 0: none. */
  timeout?: number;
  signal?: AbortSignal;
}

/** Follows a publisher over a connection to NATS (gi-server --nats), which stays the caller's. */
export function connectNats(nats: NatsConnection, options?: NatsOptions): Promise<Connection>;
