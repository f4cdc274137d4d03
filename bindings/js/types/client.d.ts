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
