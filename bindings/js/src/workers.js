// Where players run: on the caller's thread, or in workers. Both have the same calls, which return
// promises.
import {GicodecError} from './error.js';
import {Instance} from './instance.js';
import {LocalPlayer} from './local_player.js';
import workerText from 'gicodec:text/worker';

/** A player of the caller's thread, as those of workers. */
class Here {
  #player;

  async create(module) {
    this.#player = new LocalPlayer(await Instance.create(module));
  }

  async call(method, values) {
    return this.#player[method](...values);
  }

  close() {
    this.#player = null;
  }
}

/** A worker of a browser, Deno or Node, which begins with its module. */
class Worker {
  players = 0;
  #post;
  #end;
  #request = 0;
  #waiting = new Map();
  #ended = null;  // why

  static async start(module) {
    const worker = new Worker();
    const take = (message) => worker.#take(message);
    const fail = (error) => worker.#fail(error);
    if (typeof globalThis.Worker === 'function') {
      const url = URL.createObjectURL(new Blob([workerText], {type: 'text/javascript'}));
      const made = new globalThis.Worker(url, {type: 'module', name: 'gicodec'});
      made.onmessage = ({data}) => take(data);
      made.onerror = (event) => fail(new Error(`a worker failed: ${event.message ?? 'it could not start; a content security policy needs worker-src blob:'}`));
      worker.#post = (message, transfer) => made.postMessage(message, transfer);
      worker.#end = () => (made.terminate(), URL.revokeObjectURL(url));
    } else {
      const name = ['node', 'worker_threads'].join(':');  // which bundlers for browsers cannot find
      const {Worker: Thread} = await import(/* @vite-ignore */ /* webpackIgnore: true */ name);
      const made = new Thread(`${NODE}${workerText}`, {eval: true});
      made.on('message', take);
      made.on('error', fail);
      made.unref();
      worker.#post = (message, transfer) => made.postMessage(message, transfer);
      worker.#end = () => made.terminate();
      worker.ref = () => made.ref();
      worker.unref = () => made.unref();
    }
    await worker.request(0, 'module', [module]);
    return worker;
  }

  ref() {}
  unref() {}

  request(player, method, values, transfer = []) {
    return new Promise((resolve, reject) => {
      if (this.#ended) throw this.#ended;
      const request = ++this.#request;
      this.#post({request, player, method, values}, transfer);
      this.#waiting.set(request, {resolve, reject});
      this.ref();
    });
  }

  #take({request, result, error}) {
    const waiting = this.#waiting.get(request);
    if (!waiting) return;  // the answer came after the end
    const {resolve, reject} = waiting;
    this.#waiting.delete(request);
    if (this.#waiting.size === 0) this.unref();
    if (!error) return resolve(result);
    if (error.status !== undefined) return reject(new GicodecError(error.status, error.message));
    reject(new ({RangeError, TypeError}[error.type] ?? Error)(error.message));
  }

  #fail(error) {
    this.#ended = error;
    for (const {reject} of this.#waiting.values()) reject(error);
    this.#waiting.clear();
    this.unref();
  }

  end() {
    this.#fail(new Error('useWorkers() ended the worker of this player: open the container again'));
    this.#end();
  }
}

// What a page's worker has and a thread of Node lacks.
const NODE = `const {parentPort} = require('node:worker_threads');
globalThis.self = {postMessage: (message, transfer) => parentPort.postMessage(message, transfer)};
parentPort.on('message', (data) => self.onmessage({data}));
`;

const ARRAYS = {Uint8Array, Uint16Array, Uint32Array, Int8Array, Int16Array, Int32Array, Float32Array};

/** A player of a worker. */
class There {
  static #numbers = 0;
  #worker;
  #number = ++There.#numbers;

  constructor(worker) {
    this.#worker = worker;
    ++worker.players;
  }

  create() {
    return this.#worker.request(this.#number, 'create', []);
  }

  async call(method, values, transfer) {
    const result = await this.#worker.request(this.#number, method, values, transfer);
    if (!result?.textures) return result;
    return {...result, textures: result.textures.map(({arrayType, ...desc}) =>
      (arrayType ? {...desc, ArrayType: ARRAYS[arrayType]} : desc))};
  }

  close() {
    if (!this.#worker) return;
    --this.#worker.players;
    this.#worker.request(this.#number, 'close', []).catch(() => {});
    this.#worker = null;
  }
}

const MOST_WORKERS = 64;
let workers = [];

/** Starts that many workers for the players that are opened from now on; 0: the caller's thread. */
export async function useWorkers(module, count) {
  if (!Number.isInteger(count) || count < 0 || count > MOST_WORKERS) {
    throw new RangeError(`useWorkers() takes a number from 0 to ${MOST_WORKERS}; some fewer than processors do best`);
  }
  const before = workers;
  workers = [];
  before.forEach((worker) => worker.end());
  const compiled = await module.compiled();
  workers = await Promise.all(Array.from({length: count}, () => Worker.start(compiled)));
}

/** Where the next player runs: the worker with the fewest. */
export async function place(module) {
  const free = workers.reduce((a, b) => (a === null || b.players < a.players ? b : a), null);
  const host = free === null ? new Here() : new There(free);
  await host.create(free === null ? await module.compiled() : null);
  return host;
}
