// VkFormat's formats as three.js and WebGL have them: texels go to the GPU as they are.
import {
  FloatType, HalfFloatType, RedFormat, RedIntegerFormat, RGBAFormat, RGBFormat, RGFormat, UnsignedByteType,
  UnsignedInt101111Type, UnsignedInt5999Type, UnsignedIntType,
} from 'three';

/**
 * By format: format and type of a texture, their names in WebGL, bytes of a texel, and of formats that no API
 * of browsers has the first bits of red, green and blue in a word, by which shaders read them.
 */
const FORMATS = {
  A2R10G10B10_UNORM_PACK32: [RedIntegerFormat, UnsignedIntType, 'RED_INTEGER', 'UNSIGNED_INT', 4, [20, 10, 0]],
  A2B10G10R10_UNORM_PACK32: [RedIntegerFormat, UnsignedIntType, 'RED_INTEGER', 'UNSIGNED_INT', 4, [0, 10, 20]],
  R8_UNORM: [RedFormat, UnsignedByteType, 'RED', 'UNSIGNED_BYTE', 1],
  R8G8B8A8_UNORM: [RGBAFormat, UnsignedByteType, 'RGBA', 'UNSIGNED_BYTE', 4],
  R16G16_SFLOAT: [RGFormat, HalfFloatType, 'RG', 'HALF_FLOAT', 4],
  R16G16B16A16_SFLOAT: [RGBAFormat, HalfFloatType, 'RGBA', 'HALF_FLOAT', 8],
  R32G32_SFLOAT: [RGFormat, FloatType, 'RG', 'FLOAT', 8],
  R32G32B32A32_SFLOAT: [RGBAFormat, FloatType, 'RGBA', 'FLOAT', 16],
  B10G11R11_UFLOAT_PACK32: [RGBFormat, UnsignedInt101111Type, 'RGB', 'UNSIGNED_INT_10F_11F_11F_REV', 4],
  E5B9G9R9_UFLOAT_PACK32: [RGBFormat, UnsignedInt5999Type, 'RGB', 'UNSIGNED_INT_5_9_9_9_REV', 4],
};

/** Whether a renderer filters textures of float; one that is not known counts as one of a desktop. */
export function filtersFloat(renderer) {
  if (!renderer) return true;
  return renderer.isWebGPURenderer ? renderer.hasFeature('float32-filterable') : renderer.extensions.has('OES_texture_float_linear');
}

/** {format, type, glFormat, glType, bytes, words} of a format; null: there is none. */
export function formatOf(name) {
  if (!Object.hasOwn(FORMATS, name)) return null;
  const [format, type, glFormat, glType, bytes, words = null] = FORMATS[name];
  return {format, type, glFormat, glType, bytes, words};
}
