import type {Group, Light, Loader, LoadingManager, Vector3, Box3, Data3DTexture} from 'three';
import type {OwnBytes, Source} from './index.js';

/** A frame of a container. `time` is null where states have names alone. */
export interface State { readonly frame: number; readonly time: number | null; readonly name: string }

/** LightProbeGrid, or LightProbeGridWebGL, with the states of a container. */
export interface StateGrid extends Light {
  readonly isLightProbeGrid: true;
  readonly resolution: Vector3;
  readonly boundingBox: Box3;
  priority: number;
  readonly texture: Data3DTexture | null;
  /** Its states, by frame. */
  readonly states: readonly State[];
  /** A time, between two states a blend of them, or a name. Decoded when it is set: see setState(). */
  state: number | string;
  /** Resolves once the texture shows that state, or a later one was asked for. Events: "state", "error". */
  setState(state: number | string): Promise<void>;
}

/**
 * Loads containers (.gic): `scene.add(await new GILoader().loadAsync('room.gic'))` lights a scene. Several
 * volumes come as a Group. Where the server sends parts of files, only what a state needs is loaded.
 */
export class GILoader extends Loader<StateGrid | Group> {
  constructor(manager?: LoadingManager);
  /** Turns textures of float to half, which loses bits. */
  half: boolean;
  /** Says for which renderer objects are made: without it for WebGLRenderer that filters float. */
  detectSupport(renderer: object): this;
  /** Decodes in that many workers, whatever loads; 0: on the page's thread. */
  setWorkerLimit(count: number): this;
  parse(source: Source): Promise<StateGrid | Group>;
  parse(source: Source, onLoad: (object: StateGrid | Group) => void, onError?: (error: unknown) => void): void;
  abort(): this;
  /** Ends what loads. Objects that were made end with their own dispose(). */
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
