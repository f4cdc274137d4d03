// GIClient: the light of a gi-server in a scene, as it changes.
import {EventDispatcher, Group, Vector3} from 'three';
import workerText from 'gicodec:text/three/client_worker';

import {NatsBus} from '../nats.js';
import {ClientHost} from './client_host.js';
import {findShown, useVolumes} from './shown.js';
import {Tiles} from './tilings.js';

/** Milliseconds between viewpoints. */
const VIEW_EVERY = 100;
const OPTIONS = ['token', 'delivery', 'budgetBlocks', 'budgetBytes', 'limits', 'timeout', 'everything', 'worker', 'signal', 'metadata',
                 'prefix', 'reach'];

/**
 * Follows a server. `object` has its volumes, and is part of the scene. Events: "connected", "update" (with
 * what it cost), "volumes", "lost" (wait, why; it tries again), "closed" (reason), "error".
 */
export class GIClient extends EventDispatcher {
  /** What it shows. */
  object = new Group();
  statistics = {updates: 0, bytes: 0, blocks: 0, uploadedBytes: 0, decodeMs: 0, uploadMs: 0, losses: 0};
  state = null;
  #renderer;
  #metadata;
  #turn = Promise.resolve();
  #send;
  #free = () => {};
  #volumes = new Map();
  #viewed = 0;
  #ended = false;
  #failed = false;
  #nats;
  #bus;

  /**
   * `source`: wss://HOST:PORT of gi-server --listen-web, or a connection of @nats-io/nats-core, to which
   * gi-server --nats publishes. `worker: false` decodes on the page's thread.
   */
  constructor(renderer, source, options = {}) {
    super();
    for (const name of Object.keys(options)) {
      if (!OPTIONS.includes(name)) throw new TypeError(`there is no option ${name}: there are ${OPTIONS.join(', ')}`);
    }
    const {worker = true, signal, metadata, ...rest} = options;
    this.#renderer = renderer;
    this.#metadata = metadata;
    this.object.name = 'GIClient';
    if (signal?.aborted) throw signal.reason;
    signal?.addEventListener('abort', () => this.dispose(), {once: true});
    if (typeof source === 'object') this.#nats = source;
    const url = this.#nats ? undefined : `${source}`;
    this.#start(worker && typeof Worker === 'function', {url, options: rest}).catch((error) => this.#fail(error));
  }

  async #start(worker, message) {
    const {compiledClient} = await import('gicodec:entry/client');  // with its own module
    const module = await compiledClient();
    await useVolumes(this.#renderer);
    if (this.#ended) return;
    const take = (one) => (one.type === 'bus' ? this.#ended || this.#useBus(one) : this.#take(one));
    if (worker) {
      const url = URL.createObjectURL(new Blob([workerText], {type: 'text/javascript'}));
      const made = new Worker(url, {name: 'gicodec client'});
      made.onmessage = ({data}) => take(data);
      made.onerror = ({message: why}) => this.#fail(new Error(
          `the worker failed: ${why ?? 'it could not start; a content security policy needs worker-src blob:'}`));
      this.#send = (one, transfer) => made.postMessage(one, transfer);
      this.#free = () => { made.terminate(); URL.revokeObjectURL(url); };
    } else {
      const host = new ClientHost(take);
      this.#send = (one) => host.take(one);
      this.#free = () => host.take({type: 'close'});
    }
    this.#send({type: 'connect', module, ...message});
  }

  /** What the client asks of the page's connection. */
  #useBus({call, value}) {
    const tell = (name, one, transfer) => this.#send({type: 'bus', call: name, value: one}, transfer);
    this.#bus ??= new NatsBus(this.#nats, {
      take: (bytes) => {
        const copy = bytes.slice();  // of a message in what arrived at once
        tell('take', copy, [copy.buffer]);
      },
      lost: (why) => tell('lost', why),
      failed: (error) => tell('failed', error),
    });
    this.#bus[call](value);
  }

  /** Follows messages one after the other. */
  #take({type, ...values}) {
    this.#turn = this.#turn.then(() => this.#ended || this.#failed || this.#follow(type, values)).catch((error) => this.#fail(error));
  }

  #follow(type, values) {
    switch (type) {
      case 'volumes': return this.#setVolumes(values.volumes);
      case 'update': return this.#update(values);
      case 'lost':
        ++this.statistics.losses;
        return this.dispatchEvent({type, ...values});
      case 'closed':
        this.dispatchEvent({type, ...values});
        return this.#free();
      default:
        return this.#fail(Object.assign(new Error(values.error.message), values.error));
    }
  }

  #fail(error) {
    if (this.#failed) return;
    this.#failed = true;
    this.#free();
    console.error('GIClient:', error);
    this.dispatchEvent({type: 'error', error});
  }

  async #setVolumes(volumes) {
    this.#forget();
    for (const {id, textures, ...rest} of volumes) {
      const volume = {...rest, metadata: this.#metadata?.(rest) ?? {}, firstTexture: 0, textures: textures.length};
      const whole = textures.map((one) => ({...one, ArrayType: globalThis[one.arrayType], metadata: {}}));
      const found = findShown(volume, whole);
      if (!found) {
        console.info(`GIClient: ${JSON.stringify(volume.name)}, of kind ${volume.kind}, has no texture that a GPU can have`);
        continue;
      }
      const shown = await found.make(this.#renderer).catch((error) => {
        console.error(`GIClient: ${JSON.stringify(volume.name)} is left out:`, error);
      });
      if (!shown) continue;
      if (this.#ended) return shown.dispose();
      const texels = new Map(whole.map(({ArrayType, textureBytes}, i) => (
          [i, new ArrayType(textureBytes / ArrayType.BYTES_PER_ELEMENT)])));
      shown.setTexels(texels);
      this.#volumes.set(id, {shown, texels, textures: whole, tiles: whole.map((one) => new Tiles(one))});
      this.object.add(shown);
    }
    this.dispatchEvent({type: 'volumes', names: volumes.map(({name}) => name)});
  }

  #forget() {
    for (const {shown} of this.#volumes.values()) {
      shown.removeFromParent();
      shown.dispose();
    }
    this.#volumes.clear();
  }

  #update({state, decodeMs, geometries, parts}) {
    const began = performance.now();
    const before = this.state;
    this.state = state;
    let uploaded = 0, blocks = 0;
    for (const {id, geometry} of geometries) this.#volumes.get(id)?.shown.setGeometry?.(geometry);
    for (const {id, texture, blocks: changed, bytes} of parts) {
      const volume = this.#volumes.get(id);
      if (!volume) continue;
      const all = new Uint8Array(volume.texels.get(texture).buffer);
      let at = 0;
      for (const block of changed) {
        volume.tiles[texture].forRows(block, (first, end) => {
          all.set(bytes.subarray(at, at + end - first), first);
          at += end - first;
        });
      }
      uploaded += volume.shown.setBlocks(texture, changed, volume.texels);
      blocks += changed.length;
    }
    const uploadMs = performance.now() - began;
    const {statistics} = this;
    ++statistics.updates;
    statistics.bytes = state.bytes;
    statistics.blocks += blocks;
    statistics.uploadedBytes += uploaded;
    statistics.decodeMs += decodeMs;
    statistics.uploadMs += uploadMs;
    // One update a picture: a page in the background asks for none.
    requestAnimationFrame(() => this.#ended || this.#send({type: 'drawn'}));
    if (!before?.connected) this.dispatchEvent({type: 'connected'});
    this.dispatchEvent({type: 'update', state, blocks, decodeMs, uploadMs, uploadedBytes: uploaded});
  }

  /** The texels of a volume's textures as of the last update, by name. */
  texels(name = undefined) {
    const found = [...this.#volumes.values()].find(({shown}) => name === undefined || shown.name === name);
    return found && Object.fromEntries(found.textures.map((one, i) => [one.name, found.texels.get(i)]));
  }

  /** Tells the server where the camera is, at most ten times a second, so that it sends what is near first. */
  setView(camera, time = 0) {
    const now = performance.now();
    if (!this.#send || now - this.#viewed < VIEW_EVERY) return;
    this.#viewed = now;
    const eye = camera.getWorldPosition(new Vector3());
    const target = camera.getWorldDirection(new Vector3()).add(eye);
    const up = new Vector3(0, 1, 0).transformDirection(camera.matrixWorld);
    this.#send({type: 'view', viewpoint: {eye: eye.toArray(), target: target.toArray(), up: up.toArray(),
                                          fovY: camera.fov ?? 60, aspect: camera.aspect ?? 1, time}});
  }

  /** Ends the session and frees what it shows. */
  dispose() {
    if (this.#ended) return;
    this.#ended = true;
    this.#send?.({type: 'close'});
    this.#bus?.close();
    setTimeout(this.#free, 1000);  // once the goodbye is sent
    this.#forget();
    this.object.removeFromParent();
  }
}
