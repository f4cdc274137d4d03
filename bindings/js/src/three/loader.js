// GILoader: containers as objects of a scene.
import {Group, Loader} from 'three';
import {fetchRanges, open, useWorkers} from 'gicodec:entry/index';

import sample from 'gicodec:sample';

import {findShown, useVolumes} from './shown.js';
import {States, addStates} from './states.js';

/** What can be read anywhere, since states are: parts of a file, and all of a stream. */
async function seekable(source) {
  if (source instanceof Blob) {
    return {size: source.size, read: (offset, size) => source.slice(offset, offset + size).arrayBuffer()};
  }
  const stream = source instanceof Response && source.ok ? source.body : source;
  return stream instanceof ReadableStream ? new Response(stream).arrayBuffer() : source;
}

let warmed = null;

/** Decodes a little while bytes are on their way: engines compile functions when they first run. */
async function warm() {
  const player = await open(Uint8Array.from(sample, (one) => one.charCodeAt(0)));
  await player.next();
  await player.read(0);
  player.close();
}

/** Loads containers (.gic). */
export class GILoader extends Loader {
  #renderer = null;
  #workers = null;
  #ended = new AbortController();
  /** Turns textures of float to half, which loses bits. */
  half = false;
  /** Of what a file may claim, as those of open(). */
  limits = {maxTotalBytes: 512 << 20};

  /** Says for which renderer objects are made: without it, for WebGLRenderer on a desktop. */
  detectSupport(renderer) {
    if (!renderer) throw new TypeError('detectSupport() takes the renderer that will draw');
    this.#renderer = renderer;
    return this;
  }

  /** Decodes in that many workers, whatever loads; 0: on the page's thread. */
  setWorkerLimit(count) {
    this.#workers = useWorkers(count);
    this.#workers.catch(() => {});
    return this;
  }

  load(url, onLoad, onProgress, onError) {
    const address = this.manager.resolveURL((this.path ?? '') + url);
    this.manager.itemStart(address);
    this.#load((signal, tell) => this.#fetch(address, signal, tell), onProgress ?? (() => {})).catch((error) => {
      if (error instanceof Error && !error.message.includes(address)) error.message = `${address}: ${error.message}`;
      throw error;
    }).then((object) => {
      onLoad?.(object);
      this.manager.itemEnd(address);
    }, (error) => {
      if (onError) onError(error);
      else console.error(error);
      this.manager.itemError(address);
      this.manager.itemEnd(address);
    });
  }

  /** Makes objects of a container's bytes, or anything else that open() takes. */
  parse(source, onLoad, onError) {
    const made = this.#load(async () => ({source: await source}), () => {});
    if (onLoad || onError) made.then(onLoad, onError);
    return made;
  }

  abort() {
    this.#ended.abort();
    this.#ended = new AbortController();
    return this;
  }

  /** Ends what loads. Objects that were made end with their own dispose(). */
  dispose() {
    this.abort();
  }

  /** Calls begin(signal, tell) and makes objects of what it resolves to: what ends the loader ends this, until then. */
  async #load(begin, onProgress) {
    const own = new AbortController(), all = this.#ended.signal;
    const stop = () => own.abort(all.reason);
    all.addEventListener('abort', stop, {once: true});
    let loaded = 0, made = false;
    warmed ??= warm().catch(() => {});
    const tell = (bytes, total) => {
      loaded += bytes;
      if (!made) onProgress(new ProgressEvent('progress', {lengthComputable: total > 0, loaded, total}));
    };
    try {
      const {source, whole, type} = await begin(own.signal, tell);
      return await this.#make(await seekable(source), {whole, type}, own.signal);
    } finally {
      made = true;
      all.removeEventListener('abort', stop);
    }
  }

  async #fetch(url, signal, tell) {
    const source = await fetchRanges(url, {
      headers: {...this.requestHeader}, credentials: this.withCredentials ? 'include' : 'same-origin',
      signal,
    });
    if (!(source instanceof Response)) {
      return {type: source.type, source: {...source, async read(offset, size) {
        const bytes = await source.read(offset, size);
        tell(bytes.length, source.size);
        return bytes;
      }}};
    }
    if (!source.ok || !source.body) return {source};  // open() says what is wrong with it
    const total = Number(source.headers.get('content-length') ?? 0);
    const counted = source.body.pipeThrough(new TransformStream({transform(chunk, controller) {
      tell(chunk.length, total);
      controller.enqueue(chunk);
    }}));
    return {source: counted, whole: source.url || url, type: source.headers.get('content-type')};
  }

  /** `whole`: the URL of a file that came as a whole; `type`: what its server calls it. */
  async #make(source, {whole, type}, signal) {
    await this.#workers;
    const player = await open(source, {signal, limits: this.limits}).catch((error) => {
      if (error.code === 'not_gicodec' && type) error.message += `: the server brings ${type}`;
      throw error;
    });
    try {
      return await this.#objects(player, whole);
    } catch (error) {
      player.close();
      throw error;
    }
  }

  async #objects(player, whole) {
    const shown = player.volumes.map((volume) => findShown(volume, player.textures)).filter(Boolean);
    if (shown.length === 0) {
      const kinds = player.volumes.map(({kind}) => kind).join(', ');
      throw new TypeError(`the container has no texture that a GPU can have: it has volumes of kind ${kinds}`);
    }
    const frames = await player.frames();
    if (frames.length === 0) throw new RangeError('the container has no whole frame: it is empty, or was cut off');
    if (whole && frames.length > 1) {
      console.info(`GILoader: the server of ${whole} sends no parts of files, so all states are loaded at once`);
    }
    const states = new States(player, frames, shown.flatMap(({textures}) => textures));
    const release = states.use();
    states.frame(states.all[0].frame).catch(() => {});  // decodes while what shows it is loaded
    const objects = [];
    try {
      await useVolumes(this.#renderer);
      const wrong = [];
      for (const {name, make} of shown) {
        try {
          const object = await make(this.#renderer, {half: this.half});
          objects.push(object);
          if (object.isTextureVolume) {
            console.info(`GILoader: ${JSON.stringify(name)} (layout ${object.layout || 'not said'}) lights nothing by itself: ` +
                         `its textures, ${[...object.textures.keys()].join(', ')}, are for shaders of yours`);
          }
        } catch (error) {
          wrong.push(error);
          if (wrong.length < shown.length) console.error(`GILoader: ${JSON.stringify(name)} is left out:`, error);
        }
      }
      if (objects.length === 0) throw wrong[0];
      for (const object of objects) await addStates(object, states);
    } catch (error) {
      objects.forEach((object) => object.dispose());
      throw error;
    } finally {
      release();
    }
    if (objects.length === 1) return objects[0];
    const group = new Group().add(...objects);
    const dispose = group.dispose?.bind(group);
    group.dispose = () => {
      objects.forEach((object) => object.dispose());
      dispose?.();
    };
    return group;
  }
}
