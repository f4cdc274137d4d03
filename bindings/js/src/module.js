// The modules of the package: the text in which one is embedded, or bytes that the caller serves.
import {GicodecError, checkResponse} from './error.js';
import {Instance} from './instance.js';
import {UNSUPPORTED_FEATURE} from './interface.js';

// (module (func (result v128) i32.const 0 i8x16.splat))
const VECTORS = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 8, 1, 6, 0, 65, 0, 253, 15, 11,
]);

/** Whether this engine runs WebAssembly at all. */
export const supported = typeof WebAssembly === 'object' && typeof WebAssembly.instantiate === 'function';
/** Whether it has vector instructions, with which decoding is several times as fast. */
export const simd = supported && WebAssembly.validate(VECTORS);

/** One module, compiled when it is first needed. */
export class Module {
  #name;
  #call;
  #texts;
  #compiled = null;

  /**
   * @param {string} name of its file
   * @param {string} call one of its exports that no other has
   * @param {{simd: string, scalar: string}} texts a character for each byte
   */
  constructor(name, call, texts) {
    this.#name = name;
    this.#call = call;
    this.#texts = texts;
  }

  /**
   * Takes the bytes of a module in place of those that are embedded: a Response, bytes, or a compiled
   * module, or a promise of one.
   */
  use(source) {
    this.#compiled = Promise.resolve(source).then((given) => {
      if (given instanceof WebAssembly.Module) return given;
      if (typeof Response !== 'undefined' && given instanceof Response) {
        checkResponse(given);
        return given.arrayBuffer().then((bytes) => WebAssembly.compile(bytes));
      }
      return WebAssembly.compile(given);
    });
    this.#compiled = this.#compiled.then((module) => {
      if (WebAssembly.Module.exports(module).some(({name}) => name === this.#call)) return module;
      throw new TypeError(`these are not the bytes of ${this.#name}.wasm or ${this.#name}-scalar.wasm`);
    });
    return this.#compiled.then(() => undefined);
  }

  /** Resolves once it is compiled; begins with that when somebody waits. */
  get ready() {
    return {then: (...handlers) => this.compiled().then(() => undefined).then(...handlers)};
  }

  /** @returns {Promise<WebAssembly.Module>} */
  compiled() {
    if (!supported) {
      return Promise.reject(new GicodecError(UNSUPPORTED_FEATURE, 'this engine has no WebAssembly'));
    }
    this.#compiled ??= WebAssembly.compile(bytesOfText(simd ? this.#texts.simd : this.#texts.scalar));
    return this.#compiled;
  }

  /** An instance of it. */
  async create() {
    return Instance.create(await this.compiled());
  }
}

function bytesOfText(text) {
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}
