// The entry "gicodec/encoder".
import * as encoder from './encoder.js';
import {Module} from './module.js';
import * as writer from './writer.js';
import texts from 'gicodec:module/encoder';

const module = new Module('encoder', 'gicodec_encoder_encode', texts);

export {GicodecError} from './error.js';
export {simd, supported} from './module.js';

export const {ready} = module;
export const useModule = (source) => module.use(source);

export const Encoder = {create: (desc, options) => encoder.Encoder.create(module, desc, options)};
export const VolumeEncoder = {
  create: (volume, options) => encoder.VolumeEncoder.create(module, volume, options),
};
export const Writer = {create: (volumes, options) => writer.Writer.create(module, volumes, options)};

export const ddgiIrradiance = (grid, format = 'A2B10G10R10_UNORM_PACK32') =>
  encoder.described(module, 'ddgi_irradiance', encoder.sides('a grid', grid, 3), format);
export const ddgiVisibility = (grid, format = 'R16G16_SFLOAT') =>
  encoder.described(module, 'ddgi_visibility', encoder.sides('a grid', grid, 3), format);
export const mapTexture = (size, format, block = [16, 16, 1]) => encoder.described(
    module, 'map_texture', [...encoder.sides('a size', size, 1), ...encoder.sides('a block', block, 2)], format);
export const volumeOfLayout = (layout, grid) =>
  encoder.volumeOf(module, layout, encoder.sides('a grid', grid, 3));
export const layouts = () => encoder.layouts(module);
export const formats = () => encoder.formats(module);
