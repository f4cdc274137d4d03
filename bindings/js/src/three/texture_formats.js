// VkFormat's formats as three.js has them: texels go to the GPU as they are.
import {
  FloatType, HalfFloatType, RedFormat, RedIntegerFormat, RGBAFormat, RGBFormat, RGFormat, UnsignedByteType,
  UnsignedInt101111Type, UnsignedInt5999Type, UnsignedIntType,
} from 'three';

/**
 * By format: format and type of a texture, the array of its texels, and of formats that no API of browsers
 * has, how a shader reads their words: `words` has the first bits of red, green and blue.
 */
const FORMATS = {
  A2R10G10B10_UNORM_PACK32: [RedIntegerFormat, UnsignedIntType, Uint32Array, [20, 10, 0]],
  A2B10G10R10_UNORM_PACK32: [RedIntegerFormat, UnsignedIntType, Uint32Array, [0, 10, 20]],
  R8G8B8A8_UNORM: [RGBAFormat, UnsignedByteType, Uint8Array],
  R8_UNORM: [RedFormat, UnsignedByteType, Uint8Array],
  R16G16_SFLOAT: [RGFormat, HalfFloatType, Uint16Array],
  R16G16B16A16_SFLOAT: [RGBAFormat, HalfFloatType, Uint16Array],
  R32G32_SFLOAT: [RGFormat, FloatType, Float32Array],
  R32G32B32A32_SFLOAT: [RGBAFormat, FloatType, Float32Array],
  B10G11R11_UFLOAT_PACK32: [RGBFormat, UnsignedInt101111Type, Uint32Array],
  E5B9G9R9_UFLOAT_PACK32: [RGBFormat, UnsignedInt5999Type, Uint32Array],
};

/** {format, type, ArrayType, words} of a texture of this name's format; null: there is none. */
export function formatOf(name) {
  const row = FORMATS[name];
  return row ? {format: row[0], type: row[1], ArrayType: row[2], words: row[3] ?? null} : null;
}
