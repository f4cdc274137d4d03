import type {Bytes, Geometry, OwnBytes, Texels, Texture, TextureDesc, Three, VolumeDesc} from './common.js';
export * from './common.js';

export type Preset = 'turbo' | 'fast' | 'strong';
/** Blocks to code: those that changed, all, or a list. */
export type Blocks = 'changed' | 'all' | Iterable<number>;

export interface EncoderOptions {
  preset?: Preset;
  /** A keyframe every so many packets, 30; 0: only the first. */
  gop?: number;
  /** Most blocks of a chunk. */
  chunk?: number;
  /** 0: lossless; below 1 relative, else codes or representable values. Of volumes also one for each texture. */
  maxError?: number | number[];
  /** The number of the first texture in packets. */
  firstTexture?: number;
}

/** Turns successive contents of one texture into packets; the first one is a keyframe. */
export interface Encoder {
  readonly desc: Texture;
  encode(texture: Bytes, blocks?: Blocks): OwnBytes;
  /** A keyframe of what decoders hold, for those that join late. */
  snapshot(): OwnBytes;
  requestKeyframe(): void;
  setPreset(preset: Preset): void;
  /** Leaves inactive blocks out of "changed"; null: all are active. */
  setActive(active: Iterable<number | boolean> | null): void;
  setPresence(presence: Bytes): void;
  /** The texture as decoders hold it. */
  read(): Texels;
  read<T extends ArrayBufferView>(into: T): T;
  readonly sequence: number;
}
export const Encoder: {create(desc: TextureDesc, options?: EncoderOptions): Promise<Encoder>};

/** Turns successive contents of all textures of a volume into updates: one packet for each. */
export interface VolumeEncoder {
  readonly textures: Texture[];
  /** The packets of an update, in the order in which decoders must apply them. */
  encode(textures: Record<string, Bytes>, blocks?: Blocks): OwnBytes[];
  snapshot(): OwnBytes[];
  requestKeyframe(): void;
  setPreset(texture: string | number, preset: Preset): void;
}
export const VolumeEncoder: {create(volume: VolumeDesc, options?: EncoderOptions): Promise<VolumeEncoder>};

export type WrittenVolume = VolumeDesc & {geometry?: Partial<Geometry>; metadata?: Record<string, string>};

/** Writes a container. */
export interface Writer {
  /** Encodes the textures of volumes as a frame; of the only volume also without its name. */
  add(frame: number, volumes: Record<string, Record<string, Bytes>> | Record<string, Bytes>, blocks?: Blocks): void;
  /** Adds a packet that another encoder made. */
  addPacket(frame: number, packet: Bytes): void;
  /** The bytes since the last call, for those that send the container while it grows. */
  take(): OwnBytes;
  /** Ends the container: its bytes, or those since take(). */
  finish(): OwnBytes;
}
export const Writer: {
  create(volumes: Record<string, WrittenVolume>,
    options?: EncoderOptions & {scene?: string; metadata?: Record<string, string>}): Promise<Writer>;
};

/** A DDGI volume's colour: probes of 8 × 8 texels with a guard band, as one atlas. */
export function ddgiIrradiance(grid: Three, format?: string | number): Promise<Texture>;
/** A DDGI volume's visibility: probes of 16 × 16 texels with a guard band, as one atlas. */
export function ddgiVisibility(grid: Three, format?: string | number): Promise<Texture>;
/** A 2D map, array or 3D texture of width × height [× depth] records, cut into blocks. */
export function mapTexture(size: readonly number[], format: string | number, block?: Three): Promise<Texture>;
/** The volume of an engine's layout; layouts() names them. */
export function volumeOfLayout(layout: string, grid: Three): Promise<VolumeDesc>;
/** Engines' layouts, and a line about each. */
export function layouts(): Promise<Record<string, string>>;
/** All formats, by VkFormat's name without VK_FORMAT_. */
export function formats(): Promise<string[]>;
