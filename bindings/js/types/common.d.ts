/** What a call of the library, or damaged bytes, lead to. */
export class GicodecError extends Error {
  /** One of the library's statuses, e.g. 301. */
  readonly status: number;
  /** The same by name, e.g. "corrupt". */
  readonly code: string;
}

/** Whether this engine runs WebAssembly at all. */
export const supported: boolean;
/** Whether it has vector instructions. */
export const simd: boolean;
/** Resolves once the module is compiled. Every call waits for it by itself. */
export const ready: PromiseLike<void>;
/** Takes the bytes of the entry's .wasm file (simd) or -scalar.wasm from the caller, before any other call. */
export function useModule(source: ModuleSource | PromiseLike<ModuleSource>): Promise<void>;

export type ModuleSource = Response | Bytes;
/** An array with a buffer of its own: Uint8Array<ArrayBuffer> from TypeScript 5.7 on, Uint8Array before. */
export type OwnBytes = ReturnType<Uint8ArrayConstructor['of']>;
export type Bytes = ArrayBuffer | ArrayBufferView;
/** Components as they are where a format's are all whole and alike, else words of its records. */
export type Texels = ReturnType<
  (Uint8ArrayConstructor | Uint16ArrayConstructor | Uint32ArrayConstructor | Int8ArrayConstructor |
   Int16ArrayConstructor | Int32ArrayConstructor | Float32ArrayConstructor)['of']>;
export type Three = readonly [number, number, number] | number[];

export interface Component {
  name: string;
  /** Its lowest bit in the little-endian record. */
  offset: number;
  bits: number;
  type: 'unorm' | 'snorm' | 'uint' | 'ufloat' | 'sfloat' | 'exponent' | 'opaque';
}

export type Tiling =
  'atlas_xy_z' | 'atlas_xz_y' | 'atlas_x_yz' | 'slices_xz_y' | 'slices_xy_z' | 'blocks' | 'atlas_yz_x' | 'slices_yx_z';

/** A texture of blocks. */
export interface TextureDesc {
  /** VkFormat's name without VK_FORMAT_; without one, components describe the records. */
  format?: string | number;
  components?: Component[];
  recordBytes?: number;
  /** Blocks along x, y, z. */
  grid: Three;
  /** Records of a block, without guard band. */
  block: Three;
  guardBand?: number;
  space?: 'grid' | 'pool';
  presence?: 'all' | 'count' | 'mask' | 'brick';
  model?: 'none' | 'stacked' | 'continuous' | 'unordered' | 'octree' | 'hemispheres';
  /** Of the texture, if its last blocks are not full. */
  records?: Three;
  tiling?: Tiling;
  padBefore?: number;
  padAfter?: number;
  slots?: Three;
}

/** A description with what follows from it. Sizes in records include guard bands. */
export interface Texture extends TextureDesc {
  name?: string;
  components: Component[];
  blocks: number;
  width: number;
  height: number;
  slices: number;
  textureBytes: number;
  blockBytes: number;
  presenceBytes: number;
  ArrayType: {new(length: number): Texels; readonly BYTES_PER_ELEMENT: number};
}

export type Kind = 'probes' | 'irradiance_vectors' | 'textures' | 'irradiance_maps' | 'photons' | 'ao_points' |
  'voxels' | (string & {});
export interface NamedTexture extends TextureDesc { name: string; metadata?: Record<string, string> }
export interface TextureGroup { bundled?: boolean; textures: NamedTexture[] }
/** The textures of a volume, in groups of one grid or pool each, or all in one. */
export type VolumeDesc = {kind: Kind | number} & ({groups: TextureGroup[]} | {textures: NamedTexture[]});

export interface Geometry {
  /** Blocks along x, y, z. */
  grid: Three;
  /** Where block (0, 0, 0) stands, in world units. */
  origin: Three;
  /** From a block to the next. */
  spacing: Three;
  /** Cells that a camera-locked volume has moved. */
  scroll: Three;
}

/** What decoding may cost at most; 0: the default. */
export interface Limits {
  maxTextures?: number;
  maxTextureBytes?: number;
  maxPacketBytes?: number;
  maxTotalBytes?: number;
  maxWorkBytes?: number;
  maxDescriptionBytes?: number;
  maxMetadataBytes?: number;
  maxIndexBytes?: number;
}
