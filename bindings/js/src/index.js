// The entry "gicodec": containers and decoders.
import * as decoder from './decoder.js';
import {Module} from './module.js';
import * as player from './player.js';
import texts from 'gicodec:module/decoder';

const module = new Module('decoder', 'gicodec_player_next', texts);

export {GicodecError} from './error.js';
export {simd, supported} from './module.js';
export {fetchRanges} from './ranges.js';

/** Resolves once the module is compiled. Every call waits for it by itself. */
export const {ready} = module;
/** Takes the bytes of decoder.wasm (simd) or decoder-scalar.wasm from the caller, before any other call. */
export const useModule = (source) => module.use(source);
/** Decodes containers in that many workers from now on; 0: on the caller's thread. */
export const useWorkers = (count) => player.useWorkers(module, count);

export const Player = {open: (source, options) => player.Player.open(module, source, options)};
export const Decoder = {create: (desc, options) => decoder.Decoder.create(module, desc, options)};
export const VolumeDecoder = {
  create: (volume, options) => decoder.VolumeDecoder.create(module, volume, options),
};
export const open = Player.open;
export const peek = (packet) => decoder.peek(module, packet);
