// VkFormat's formats as three.js, WebGL and WebGPU have them: texels go to the GPU as they are.
import {
  ByteType, CompressedArrayTexture, Data3DTexture, DataArrayTexture, FloatType, HalfFloatType, LinearFilter, NearestFilter,
  RED_GREEN_RGTC2_Format, RED_RGTC1_Format, RGBA_BPTC_Format, RGBA_S3TC_DXT1_Format, RGBA_S3TC_DXT3_Format,
  RGBA_S3TC_DXT5_Format, RGBAFormat, RGBAIntegerFormat, RGB_BPTC_SIGNED_Format, RGB_BPTC_UNSIGNED_Format,
  RGB_S3TC_DXT1_Format, RGBFormat, RGFormat, RedFormat, RedIntegerFormat, SIGNED_RED_GREEN_RGTC2_Format,
  SIGNED_RED_RGTC1_Format, UnsignedByteType, UnsignedInt101111Type, UnsignedInt5999Type, UnsignedIntType,
} from 'three';

/**
 * By format: format and type of a texture, their names in WebGL, bytes of a texel, and what else there is to
 * say: `words`, of formats that no API of browsers has, the first bits of red, green and blue in a word, by
 * which shaders read them; `gl` and `gpu`, what WebGL and WebGPU call it where three.js does not.
 */
const FORMATS = {
  A2R10G10B10_UNORM_PACK32: [RedIntegerFormat, UnsignedIntType, 'RED_INTEGER', 'UNSIGNED_INT', 4, {words: [20, 10, 0]}],
  A2B10G10R10_UNORM_PACK32: [RedIntegerFormat, UnsignedIntType, 'RED_INTEGER', 'UNSIGNED_INT', 4, {words: [0, 10, 20]}],
  R8_UNORM: [RedFormat, UnsignedByteType, 'RED', 'UNSIGNED_BYTE', 1],
  R8G8_UNORM: [RGFormat, UnsignedByteType, 'RG', 'UNSIGNED_BYTE', 2],
  R8G8B8A8_UNORM: [RGBAFormat, UnsignedByteType, 'RGBA', 'UNSIGNED_BYTE', 4],
  R8G8B8A8_SNORM: [RGBAFormat, ByteType, 'RGBA', 'BYTE', 4, {gl: 'RGBA8_SNORM'}],
  R8G8B8A8_UINT: [RGBAIntegerFormat, UnsignedByteType, 'RGBA_INTEGER', 'UNSIGNED_BYTE', 4, {gpu: 'rgba8uint'}],
  B8G8R8A8_UNORM: [RGBAFormat, UnsignedByteType, 'RGBA', 'UNSIGNED_BYTE', 4, {gpu: 'bgra8unorm'}],
  R16_SFLOAT: [RedFormat, HalfFloatType, 'RED', 'HALF_FLOAT', 2],
  R16G16_SFLOAT: [RGFormat, HalfFloatType, 'RG', 'HALF_FLOAT', 4],
  R16G16B16A16_SFLOAT: [RGBAFormat, HalfFloatType, 'RGBA', 'HALF_FLOAT', 8],
  R32_SFLOAT: [RedFormat, FloatType, 'RED', 'FLOAT', 4],
  R32G32_SFLOAT: [RGFormat, FloatType, 'RG', 'FLOAT', 8],
  R32G32B32A32_SFLOAT: [RGBAFormat, FloatType, 'RGBA', 'FLOAT', 16],
  B10G11R11_UFLOAT_PACK32: [RGBFormat, UnsignedInt101111Type, 'RGB', 'UNSIGNED_INT_10F_11F_11F_REV', 4],
  E5B9G9R9_UFLOAT_PACK32: [RGBFormat, UnsignedInt5999Type, 'RGB', 'UNSIGNED_INT_5_9_9_9_REV', 4],
};

/** Formats of blocks of 4×4 texels. */
const COMPRESSED = {
  BC1_RGB_UNORM_BLOCK: RGB_S3TC_DXT1_Format, BC1_RGBA_UNORM_BLOCK: RGBA_S3TC_DXT1_Format,
  BC2_UNORM_BLOCK: RGBA_S3TC_DXT3_Format, BC3_UNORM_BLOCK: RGBA_S3TC_DXT5_Format,
  BC4_UNORM_BLOCK: RED_RGTC1_Format, BC4_SNORM_BLOCK: SIGNED_RED_RGTC1_Format,
  BC5_UNORM_BLOCK: RED_GREEN_RGTC2_Format, BC5_SNORM_BLOCK: SIGNED_RED_GREEN_RGTC2_Format,
  BC6H_UFLOAT_BLOCK: RGB_BPTC_UNSIGNED_Format, BC6H_SFLOAT_BLOCK: RGB_BPTC_SIGNED_Format,
  BC7_UNORM_BLOCK: RGBA_BPTC_Format,
};
const ARRAYS = new Map([[UnsignedByteType, Uint8Array], [ByteType, Int8Array], [HalfFloatType, Uint16Array], [FloatType, Float32Array]]);

/** Whether a renderer filters textures of float; one that is not known counts as one of a desktop. */
export function filtersFloat(renderer) {
  if (!renderer) return true;
  return renderer.isWebGPURenderer ? renderer.hasFeature('float32-filterable') : renderer.extensions.has('OES_texture_float_linear');
}

/** {format, type, glFormat, glType, bytes, words, gl, gpu} of a format; null: there is none. */
export function formatOf(name) {
  if (!Object.hasOwn(FORMATS, name)) return null;
  const [format, type, glFormat, glType, bytes, more] = FORMATS[name];
  return {format, type, glFormat, glType, bytes, ...more};
}

/** Whether shaders can filter a format, 3D textures of it too. */
export const isFiltered = (name) => Object.hasOwn(FORMATS, name) && !formatOf(name).words && formatOf(name).format !== RGBAIntegerFormat;

/** Whether a texture of that format can be made. */
export const hasFormat = (name) => Object.hasOwn(FORMATS, name) || Object.hasOwn(COMPRESSED, name);

/** What a renderer takes at most: {flat, deep, layers}, texels along a side and slices of an array; null: not known. */
function limitsOf(renderer) {
  const gl = renderer?.isWebGPURenderer ? renderer.backend.gl : renderer?.getContext?.();
  if (gl) {
    const most = (name) => gl.getParameter(gl[name]);
    return {flat: most('MAX_TEXTURE_SIZE'), deep: most('MAX_3D_TEXTURE_SIZE'), layers: most('MAX_ARRAY_TEXTURE_LAYERS')};
  }
  const limits = renderer?.backend?.device?.limits;
  return limits ? {flat: limits.maxTextureDimension2D, deep: limits.maxTextureDimension3D, layers: limits.maxTextureArrayLayers} : null;
}

/** An array texture of a description, or with `deep` a 3D texture, without texels. */
export function makeTexture({name: called, format: name, width, height, slices}, renderer, deep = false) {
  const limits = limitsOf(renderer);
  const [side, depth] = limits ? (deep ? [limits.deep, limits.deep] : [limits.flat, limits.layers]) : [Infinity, Infinity];
  if (width > side || height > side || slices > depth) {
    throw new RangeError(`${JSON.stringify(called)} is ${width} × ${height} × ${slices} texels, and this device takes ` +
                         `${side} × ${side} × ${depth}: pack it in several volumes`);
  }
  const known = formatOf(name);
  if (!known) return new CompressedArrayTexture([], 4 * width, 4 * height, slices, COMPRESSED[name], UnsignedByteType);
  const {format, type, gl, gpu} = known;
  const texture = Object.assign(new (deep ? Data3DTexture : DataArrayTexture)(null, width, height, slices), {format, type});
  const filtered = isFiltered(name) && (type !== FloatType || filtersFloat(renderer));
  texture.minFilter = texture.magFilter = filtered ? LinearFilter : NearestFilter;
  texture.internalFormat = (renderer?.backend?.isWebGPUBackend ? gpu : gl) ?? null;
  return texture;
}

/** Gives a texture its texels, which stay the caller's array. */
export function setImage(texture, texels) {
  if (texture.isCompressedTexture) {
    const {width, height} = texture.image;
    texture.mipmaps = [{data: new Uint8Array(texels.buffer, texels.byteOffset, texels.byteLength), width, height}];
    return;
  }
  const View = ARRAYS.get(texture.type) ?? Uint32Array;
  texture.image.data = new View(texels.buffer, texels.byteOffset, texels.byteLength / View.BYTES_PER_ELEMENT);
}
