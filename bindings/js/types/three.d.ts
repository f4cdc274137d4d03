import type {
  Box3, Camera, Data3DTexture, DataArrayTexture, EventDispatcher, Group, Light, Loader, LoadingManager, Object3D, Texture, Vector3,
} from 'three';
import type {ClientOptions, ClientState, NatsConnection} from './client.js';
import type {Limits} from './common.js';
import type {OwnBytes, Source, Texels} from './index.js';

/** A frame of a container. `time` is null where states have names alone. */
export interface State { readonly frame: number; readonly time: number | null; readonly name: string }

/** What a loaded object has: the states of its container, by frame. */
export interface WithStates {
  readonly states: readonly State[];
  /** A time or a name. Decoded when it is set; what goes wrong then is an event "error". See setState(). */
  get state(): number | string;
  set state(state: number | string);
  /** Resolves once that state is shown, or a later one was asked for. A time beyond the states shows the nearest. */
  setState(state: number | string): Promise<void>;
  /** "state": another one is shown. "error": one that `state` was set to cannot be. */
  addEventListener(type: 'state', listener: (event: {type: 'state', state: number | string}) => void): void;
  addEventListener(type: 'error', listener: (event: {type: 'error', error: Error}) => void): void;
  removeEventListener(type: 'state', listener: (event: {type: 'state', state: number | string}) => void): void;
  removeEventListener(type: 'error', listener: (event: {type: 'error', error: Error}) => void): void;
}

/** LightProbeGrid, or LightProbeGridWebGL. */
export interface ProbeGrid extends Light {
  readonly isLightProbeGrid: true;
  readonly resolution: Vector3;
  readonly boundingBox: Box3;
  priority: number;
  readonly texture: Data3DTexture | null;
}
/** Between two states it shows a blend of them. */
export type StateGrid = ProbeGrid & WithStates;

/** What a volume becomes. Each has dispose(). */
export type LoadedVolume = StateGrid | (ProbeVolume & WithStates) | (AmbientCubeVolume & WithStates) | (TextureVolume & WithStates);
/** Several volumes come as a Group. */
export type Loaded = LoadedVolume | (Group & {dispose(): void});

/**
 * Loads containers (.gic): `scene.add(await new GILoader().loadAsync('room.gic'))` lights a scene.
 * Where the server sends parts of files, only what a state needs is loaded.
 */
export class GILoader extends Loader<Loaded> {
  constructor(manager?: LoadingManager);
  /** Turns textures of float to half, which loses bits. */
  half: boolean;
  /** Of what a file may claim: at first 512 MB of textures. */
  limits: Limits;
  /** Says for which renderer objects are made: without it for WebGLRenderer that filters float. */
  detectSupport(renderer: object): this;
  /** Decodes in that many workers, whatever loads; 0: on the page's thread. */
  setWorkerLimit(count: number): this;
  /** `loadAsync<StateGrid>('room.gic')` where a file is known; else `instanceof`, or 'isLightProbeGrid' in it, tells. */
  loadAsync<T extends Loaded = Loaded>(url: string, onProgress?: (event: ProgressEvent) => void): Promise<T>;
  parse<T extends Loaded = Loaded>(source: Source): Promise<T>;
  parse(source: Source, onLoad: (object: Loaded) => void, onError?: (error: unknown) => void): void;
  abort(): this;
  /** Ends what loads. Objects that were made end with their own dispose(). */
  dispose(): void;
}

/**
 * A volume that lights what is drawn with it: in WebGPURenderer all, in WebGLRenderer the lit materials of its
 * scene, as they are first seen.
 */
export abstract class VolumeLight extends Light {
  /** False: only what light() is given is lit, in WebGLRenderer. */
  autoLight: boolean;
  light(object: Object3D): void;
  /** Probes or voxels along each axis. */
  readonly grid: readonly number[];
  /** Before the volume is moved: from the first probe to the last, or all that is lit. */
  readonly boundingBox: Box3;
}

/** Of kind probes (DDGI): irradiance and visibility. `state` shows the last frame at or before a time. */
export class ProbeVolume extends VolumeLight {
  private constructor();
  readonly isProbeVolume: true;
  /** As they are on the GPU, texel for texel those of the container. */
  readonly textures: {readonly color: DataArrayTexture, readonly visibility: DataArrayTexture};
  /** A probe's number is x + nx·(y + ny·z). */
  isActive(probe: number): boolean;
  /** Where a probe stands, before the volume is moved. */
  probePosition(probe: number, target?: Vector3): Vector3;
  /** When each probe changed last, as performance.now() says it. */
  readonly changedAt: Float64Array;
}

/** Ambient cubes in Bevy's layout, which light what is in their box. */
export class AmbientCubeVolume extends VolumeLight {
  private constructor();
  readonly isAmbientCubeVolume: true;
  /** As it is on the GPU, texel for texel that of the container. */
  readonly texture: Data3DTexture;
}

/** A volume that nothing here shades by: its textures, for shaders of your own. */
export class TextureVolume extends Object3D {
  private constructor();
  readonly isTextureVolume: true;
  /** The engine's, as `gicodec encode --layout` names it; "": the container does not say it. */
  readonly layout: string;
  /** By name, texel for texel those of the container. */
  readonly textures: ReadonlyMap<string, Texture>;
  /** What it lights; null: the container does not say it. */
  readonly boundingBox: Box3 | null;
  /** A slice of a texture as a texture of its own, which follows the state: a layer of a light map. */
  slice(name: string, slice?: number): Texture;
  dispose(): void;
}

/**
 * The bounds of a ProbeVolume and a sphere for each active probe: `volume.add(new ProbeVolumeHelper(volume))`.
 * Spheres have the mean light of their probes, or fade in `fade` milliseconds after their last change.
 */
export class ProbeVolumeHelper extends Group {
  constructor(volume: ProbeVolume, options?: {radius?: number, colors?: 'light' | 'age', fade?: number});
  colors: 'light' | 'age';
  fade: number;
  /** How many probes are active. */
  readonly shown: number;
  /** Shows what is new. */
  update(now?: number): void;
  dispose(): void;
}

export interface GIClientOptions extends ClientOptions {
  /** Milliseconds without a message after which a connection counts as lost: 20,000; 0: none. */
  timeout?: number;
  /** False: the server sends what setView() sees, in place of everything. */
  everything?: boolean;
  /** False: decodes on the page's thread, where a content security policy has no worker-src blob:. */
  worker?: boolean;
  /** Of a connection to NATS: that of gi-server --nats-prefix, "gicodec". */
  prefix?: string;
  /** Of a connection to NATS: up to how far from the camera regions are received, in world units; absent: all. */
  reach?: number;
  signal?: AbortSignal;
  /**
   * The metadata that a file of such a volume would have (FORMAT.md, "Keys"), which servers do not send:
   * `() => ({'gicodec:layout': 'bevy', 'gicodec:bounds': '0 0 0 8 4 8'})`.
   */
  metadata?: (volume: {id: number, name: string, kind: string}) => Record<string, string>;
}

export interface GIClientStatistics {
  updates: number;
  /** Received. */
  bytes: number;
  blocks: number;
  /** Sent to the GPU in parts: of an update that changed most of a texture three.js sends all of it. */
  uploadedBytes: number;
  decodeMs: number;
  uploadMs: number;
  losses: number;
}

export interface GIClientEvents {
  connected: object;
  /** What an update cost, once it is shown. */
  update: {state: ClientState, blocks: number, decodeMs: number, uploadMs: number, uploadedBytes: number};
  /** The server has other volumes; those that cannot be shown are not in `object`. */
  volumes: {names: string[]};
  /** The connection was lost; the next try is in `wait` milliseconds. */
  lost: {wait: number, why: string};
  /** The session ended for good. */
  closed: {reason: string};
  error: {error: Error};
}

/** The light of a gi-server in a scene, as it changes. A connection that is lost is tried again. */
export class GIClient extends EventDispatcher<GIClientEvents> {
  /** `source`: wss://HOST:PORT of gi-server --listen-web, or a connection to NATS, which stays the caller's. */
  constructor(renderer: object, source: string | NatsConnection, options?: GIClientOptions);
  /** What it shows: add it to the scene. */
  readonly object: Group;
  readonly statistics: Readonly<GIClientStatistics>;
  /** As of the last update; null before the first. */
  readonly state: ClientState | null;
  /** The texels of a volume's textures as of the last update, by name; undefined: it has no such volume. */
  texels(name?: string): Record<string, Texels> | undefined;
  /** Tells the server where the camera is, at most ten times a second. `time`: of the picture, in seconds. */
  setView(camera: Camera, time?: number): void;
  /** Ends the session and frees what it shows. */
  dispose(): void;
}

/** What a grid's texture held. */
export interface CapturedGrid {
  resolution: number[];
  /** The least corner of its box and the greatest, in metres. */
  bounds: number[];
  texels: Uint16Array | Float32Array;
}
/** Reads the texture of a baked or loaded grid from the GPU. */
export function captureLightProbeGrid(renderer: object, grid: Light): Promise<CapturedGrid>;
export interface SaveOptions {
  /** Of each state. */
  states?: {time?: number, name?: string}[];
  /** Turns float to half, which loses bits. */
  half?: boolean;
  name?: string;
  preset?: 'turbo' | 'fast' | 'strong';
}
/** The bytes of a container with a grid as it is now, or with captured ones as its states. */
export function saveLightProbeGrid(renderer: object, grid: Light | CapturedGrid[], options?: SaveOptions): Promise<OwnBytes>;
