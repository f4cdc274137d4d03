import type {Bytes, Geometry, Kind, Limits, Texels, Texture, TextureDesc, VolumeDesc} from './common.js';
export * from './common.js';

export interface VolumeInfo {
  name: string;
  kind: Kind;
  geometry?: Geometry;
  metadata: Record<string, string>;
  /** Its textures in Player.textures: the first one, and their number. */
  firstTexture: number;
  textures: number;
}

export interface ContainerTexture extends Texture {
  name: string;
  /** The place of its volume. */
  volume: number;
  /** Of decoded records; 0: lossless. */
  largestError: number;
  metadata: Record<string, string>;
}

/** A container of which open() reads what it needs. */
export interface RangeSource {
  /** Bytes of the container. */
  readonly size: number;
  /** May be called again before what it returned is there. */
  read(offset: number, size: number): Promise<Bytes> | Bytes;
  /** Looks for what was appended, and resolves to the size. For the option follow. */
  grow?(): Promise<number>;
}
/**
 * Asks a server for a file: what open() reads in parts where the server sends parts, else its response.
 * `open(fetchRanges(url))` goes to any frame of a large file without the others.
 */
export function fetchRanges(url: string | URL, init?: RequestInit): Promise<RangeSource | Response>;

export type Source = RangeSource | Response | Blob | Bytes | ReadableStream<Uint8Array> | AsyncIterable<Uint8Array>;

export interface PlayerOptions {
  limits?: Limits;
  /** Plays only these, by name or number. */
  textures?: (string | number)[];
  /** Of a volume that is cut into regions plays those with blocks from first to last, both [x, y, z]. */
  box?: {volume?: string | number; first: [number, number, number]; last: [number, number, number]};
  /** next() waits for frames that are appended to a file, until its end mark. */
  follow?: boolean;
  /** Ends the player, and what it waits for. */
  signal?: AbortSignal;
}

/**
 * Plays a container, in order or from any frame on. Calls run one after the other. Each player has
 * memory of its own, which close() frees. It has one place in the container: loops over one player
 * share its frames, and a loop that is left does not close it.
 */
export interface Player extends AsyncIterable<number> {
  readonly scene: string;
  readonly metadata: Record<string, string>;
  readonly volumes: VolumeInfo[];
  readonly textures: ContainerTexture[];
  /** Applies the next frame, once its bytes have arrived: its number, or null at the end. */
  next(): Promise<number | null>;
  /** The next next() applies that frame. Of a stream: one that has arrived. */
  seek(frame: number): Promise<void>;
  /** The numbers of the frames that can be sought; of a stream: those that have arrived. */
  frames(): Promise<number[]>;
  /**
   * A texture as of the last frame (after the first next()), guard bands included, bit by bit. With
   * `into` in that array, which a worker returns as another one over the same memory: go on with what
   * this resolves to.
   */
  read(texture: string | number): Promise<Texels>;
  read<T extends ArrayBufferView>(texture: string | number, into: T): Promise<T>;
  /** The blocks of a texture that the last frame may have changed, ascending; all after a seek. */
  changed(texture: string | number): Promise<Uint32Array>;
  close(): void;
}

export const Player: {
  /** Opens a container. Of a response or a stream, frames play as their bytes arrive. */
  open(source: Source | PromiseLike<Source>, options?: PlayerOptions): Promise<Player>;
};
/** Player.open(). */
export const open: typeof Player.open;
/** Decodes containers in that many workers from now on, and ends those before; 0: on the caller's thread. */
export function useWorkers(count: number): Promise<void>;

export interface DecoderOptions { limits?: Limits }

/** Turns the packets of one texture back into it. A packet is applied completely or not at all. */
export interface Decoder {
  readonly desc: Texture;
  decode(packet: Bytes): void;
  read(): Texels;
  read<T extends ArrayBufferView>(into: T): T;
  /** Which records exist, for a texture with presence. */
  setPresence(presence: Bytes): void;
  /** The blocks that the last packet may have changed, ascending. */
  changed(): Uint32Array;
  /** A byte for each block, not 0 if it was received. */
  received(): Uint8Array;
  /** The number of the last packet; 0 before the first. */
  readonly sequence: number;
}
export const Decoder: {create(desc: TextureDesc, options?: DecoderOptions): Promise<Decoder>};

/** Decodes the packets of a VolumeEncoder. */
export interface VolumeDecoder {
  readonly textures: Texture[];
  /** Applies the packets of an update, in their order. */
  decode(packets: Iterable<Bytes>): void;
  read(texture: string | number): Texels;
  read<T extends ArrayBufferView>(texture: string | number, into: T): T;
  changed(texture: string | number): Uint32Array;
}
export const VolumeDecoder: {
  create(volume: VolumeDesc, options?: DecoderOptions & {firstTexture?: number}): Promise<VolumeDecoder>;
};

export interface PacketInfo {
  version: number;
  type: 'keyframe' | 'delta' | 'intra' | 'snapshot' | 'catch-up' | 'intra catch-up';
  backend: string;
  textureId: number;
  lossy: boolean;
  sequence: number;
  reference: number;
  allBlocks: boolean;
  blocks: number;
  headerSize: number;
  indexSize: number;
  guardBandSize: number;
  payloadSize: number;
}
/** The head of a packet, without a decoder. */
export function peek(packet: Bytes): Promise<PacketInfo>;
