// Descriptions of textures and volumes: plain objects, as in the library's JSON, and structs.
import {GicodecError, quoted} from './error.js';
import {bytesOf} from './instance.js';
import {INVALID_NAME, UNSUPPORTED_FORMAT, textureDesc, textureInfo} from './interface.js';

const NAMES = {
  space: ['grid', 'pool'],
  presence: ['all', 'count', 'mask', 'brick'],
  model: ['none', 'stacked', 'continuous', 'unordered', 'octree', 'hemispheres'],
  tiling: ['atlas_xy_z', 'atlas_xz_y', 'atlas_x_yz', 'slices_xz_y', 'slices_xy_z', 'blocks',
           'atlas_yz_x', 'slices_yx_z'],
};
const COMPONENT_TYPES = ['unorm', 'snorm', 'uint', 'ufloat', 'sfloat', 'exponent', 'opaque'];
const ARRAYS = {
  unorm: [Uint8Array, Uint16Array, Uint32Array], uint: [Uint8Array, Uint16Array, Uint32Array],
  opaque: [Uint8Array, Uint16Array, Uint32Array], snorm: [Int8Array, Int16Array, Int32Array],
  sfloat: [Uint8Array, Uint16Array, Float32Array],
};

/** The place of a name in a list; numbers pass. */
export function numberOf(list, name, what) {
  if (typeof name === 'number') return name;
  const number = list.indexOf(name);
  if (number < 0) throw new GicodecError(INVALID_NAME, `there is no ${what} "${name}": ${list.join(', ')} are`);
  return number;
}

/** VkFormat's number by its name, with or without VK_FORMAT_. */
export function formatNumber(instance, format) {
  if (typeof format === 'number') return format;
  const number = instance.with((memory) => instance.call('format_from_name', memory.text(format)));
  if (number === 0) {
    throw new GicodecError(UNSUPPORTED_FORMAT, `there is no format "${format}"; formats have the names of ` +
                           'VkFormat, e.g. R16G16B16A16_SFLOAT');
  }
  return number;
}

/** Calls body(address) with the struct of a description. */
export function withDesc(instance, desc, body) {
  const {format, components = [], name, ...fields} = desc;
  if (!fields.grid || !fields.block || (format === undefined && components.length === 0)) {
    throw new TypeError('a description of a texture has a grid, a block, and a format or components');
  }
  for (const derived of ['ArrayType', 'components', 'volume', 'largestError', 'metadata',
                         ...Object.keys(textureInfo.fields)]) {
    delete fields[derived];
  }
  for (const [key, list] of Object.entries(NAMES)) {
    if (fields[key] !== undefined) fields[key] = numberOf(list, fields[key], key);
  }
  if (format !== undefined) {
    fields.format = formatNumber(instance, format);
    delete fields.recordBytes;
  } else {
    fields.componentCount = components.length;
    fields.components = components.map((one) => ({
      ...one, name: new TextEncoder().encode(one.name), type: numberOf(COMPONENT_TYPES, one.type, 'type'),
    }));
  }
  return instance.with((memory) => {
    const at = memory.struct(textureDesc, fields);
    instance.checkDesc('texture_desc', at, name);
    return body(at);
  });
}

/** The description of a struct, whole: with components, sizes, and the type of its arrays. */
export function readDesc(instance, at) {
  instance.check('texture_desc_complete', [at]);
  const {components, componentCount, format, records, slots, ...desc} = instance.read(textureDesc, at);
  for (const [key, list] of Object.entries(NAMES)) desc[key] = list[desc[key]] ?? desc[key];
  if (format !== 0) desc.format = instance.text(instance.call('format_name', format));
  if (records.some(Boolean)) desc.records = records;
  if (slots.some(Boolean)) desc.slots = slots;
  desc.components = components.slice(0, componentCount).map((one) => ({
    name: String.fromCharCode(...one.name.filter(Boolean)), offset: one.offset, bits: one.bits,
    type: COMPONENT_TYPES[one.type],
  }));
  return instance.with((memory) => {
    const info = memory.struct(textureInfo);
    instance.check('texture_desc_info', [at, info]);
    return {...desc, ...instance.read(textureInfo, info), ArrayType: arrayType(desc)};
  });
}

/** The same of a description that lacks what follows. */
export function complete(instance, desc) {
  return withDesc(instance, desc, (at) => readDesc(instance, at));
}

/** Components as they are where they are all whole and alike, else words of a record. */
function arrayType({components, recordBytes}) {
  const [{bits, type}] = components;
  const even = components.every(
      (one, i) => one.bits === bits && one.type === type && one.offset === i * bits);
  const place = [8, 16, 32].indexOf(bits);
  if (even && place >= 0 && ARRAYS[type]) return ARRAYS[type][place];
  return {2: Uint16Array, 4: Uint32Array}[recordBytes] ?? Uint8Array;
}

/** The handle of a volume: {kind, groups: [{bundled, textures: [{name, ...}]}]}, or {kind, textures}. */
export function createVolume(instance, {kind, groups, textures}) {
  return instance.with((memory) => {
    const volume = instance.made('volume_desc_create', [kindNumber(instance, kind)]);
    for (const group of groups ?? [{bundled: false, textures}]) {
      instance.check('volume_desc_add_group', [volume, group.bundled ? 1 : 0]);
      for (const texture of group.textures) {
        if (typeof texture.name !== 'string') {
          throw new TypeError('each texture of a volume has a name: {name: "color", ...description}');
        }
        withDesc(instance, texture, (at) => instance.check(
            'volume_desc_add_texture', [volume, memory.text(texture.name), at], {what: texture.name}));
      }
    }
    instance.checkDesc('volume_desc', volume);
    return volume;
  });
}

/** All textures of such a volume, in order, whole. */
export function texturesOf(instance, {groups, textures}) {
  return (groups ?? [{textures}]).flatMap((group) => group.textures)
      .map((texture) => ({...complete(instance, texture), name: texture.name}));
}

function kindNumber(instance, kind) {
  if (typeof kind === 'number') return kind;
  const names = [];
  for (let number = 1; number < 256; ++number) {
    const name = instance.text(instance.call('kind_name', number));
    if (name === kind) return number;
    if (name) names.push(name);
  }
  throw new GicodecError(INVALID_NAME, `there is no kind "${kind}": ${names.join(', ')} are`);
}

/** The place of a texture by its name or number. */
export function placeOf(textures, texture) {
  const place = typeof texture === 'number' ? texture : textures.findIndex((one) => one.name === texture);
  if (!textures[place]) {
    throw new RangeError(`there is no texture ${typeof texture === 'string' ? quoted(texture) : texture}: there are ` +
                         textures.map((one) => quoted(one.name)).join(', '));
  }
  return place;
}

/** Reads a texture into an array of the caller's or a new one, by a call that takes the address of a view. */
export function readTexture(instance, desc, into, read) {
  const out = into ?? new desc.ArrayType(desc.textureBytes / desc.ArrayType.BYTES_PER_ELEMENT);
  checkFit(desc, out);
  return instance.into(out, desc.textureBytes, read);
}

/** The fields of a view of the caller's texture, copied. */
export function texelsOf(memory, desc, array) {
  const bytes = bytesOf(array);
  checkFit(desc, array);
  return {bytes: memory.put(bytes), size: bytes.length};
}

/** Arrays are the bits of texels: of any integers, but not of floats where texels are something else. */
function checkFit({name, textureBytes, ArrayType, format}, array) {
  const it = name ? quoted(name) : 'the texture';
  const type = array.constructor;
  if (type.name.startsWith('Float') && type !== ArrayType) {
    throw new TypeError(`${it} takes the bits of ${format ?? 'its records'} in a ${ArrayType.name}, not a ${type.name}`);
  }
  if (array.byteLength !== textureBytes) {
    throw new RangeError(`${it} has ${textureBytes} bytes, the array ${array.byteLength}`);
  }
}
