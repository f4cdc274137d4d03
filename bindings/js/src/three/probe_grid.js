// Volumes of three.js's own layout (engines.h, three_volume) as LightProbeGrid.
import {DataUtils} from 'three';

import {AXES, boxOrCells, unitOf} from './axes.js';
import {uploadAll, uploadBlocks} from './partial_upload.js';
import {filtersFloat, makeTexture} from './texture_formats.js';
import {Tiles} from './tilings.js';

const LAYOUTS = ['three', 'three-float32'], FORMATS = ['R16G16B16A16_SFLOAT', 'R32G32B32A32_SFLOAT'];

/** Textures of a grid's atlas along z, and slices of each in front and behind, which repeat the nearest one. */
export const PARTS = 7, PADDING = 1;

/** Probes along each axis, of a texture's size. */
function resolutionOf({name, width, height, slices}) {
  const depth = slices / PARTS - 2 * PADDING;
  if (!Number.isInteger(depth) || depth < 1) {
    throw new RangeError(`${JSON.stringify(name)} has ${slices} slices, which are no ${PARTS} textures of a LightProbeGrid`);
  }
  return [width, height, depth];
}

/** The nearest half; 65504 for what is beyond. */
export const toHalf = (value) => DataUtils.toHalfFloat(Math.min(65504, Math.max(-65504, value)));

/** Texels between two states, or exactly the first. */
function blend(out, first, second, part, half) {
  if (first instanceof Uint16Array) {
    if (part === 0 && half) return out.set(first);
    const {fromHalfFloat, toHalfFloat} = DataUtils;
    for (let i = 0; i < out.length; ++i) {
      const a = fromHalfFloat(first[i]);
      out[i] = toHalfFloat(a + (fromHalfFloat(second[i]) - a) * part);
    }
    return;
  }
  if (part === 0 && !half) {  // as bits: NaN keeps its payload
    return new Uint32Array(out.buffer).set(new Uint32Array(first.buffer, first.byteOffset, first.length));
  }
  for (let i = 0; i < out.length; ++i) {
    const value = first[i] + (second[i] - first[i]) * part;
    out[i] = half ? toHalf(value) : value;
  }
}

/** The number of the texture of such a volume; null: it is no such volume. */
export function gridTextures({metadata, firstTexture}, textures) {
  return LAYOUTS.includes(metadata['gicodec:layout']) && FORMATS.includes(textures[firstTexture]?.format) ? [firstTexture] : null;
}

/** A LightProbeGrid of a volume. `half` turns float to half. */
export async function makeProbeGrid(volume, textures, renderer, {half: wanted = false} = {}) {
  const axes = volume.metadata['gicodec:axes'] ?? AXES;
  if (axes !== AXES) {
    throw new RangeError(`the axes of ${JSON.stringify(volume.name)} are ${axes}, and a LightProbeGrid's are ${AXES}: ` +
                         'bake it with these');
  }
  const place = volume.firstTexture, desc = textures[place];
  const resolution = resolutionOf(desc);
  const {least, size} = boxOrCells(volume.metadata, resolution), unit = unitOf(volume.metadata);
  const isHalf = desc.ArrayType === Uint16Array;
  const half = !isHalf && (wanted || !filtersFloat(renderer));
  if (half && !wanted) {
    console.info('GILoader: this device cannot filter textures of float, so they become half, which loses bits');
  }
  const Grid = renderer?.isWebGPURenderer
    ? (await import('three/addons/lighting/LightProbeGrid.js')).LightProbeGrid
    : (await import('three/addons/lighting/LightProbeGridWebGL.js')).LightProbeGridWebGL;
  const grid = new Grid(...size.map((side) => side * unit), ...resolution);
  grid.name = volume.name;
  grid.position.set(...least.map((at, axis) => (at + size[axis] / 2) * unit));
  grid.updateBoundingBox();

  const halves = half || isHalf;
  const shown = makeTexture({...desc, format: `R${halves ? '16G16B16A16' : '32G32B32A32'}_SFLOAT`}, renderer, true);
  shown.image.data = new (halves ? Uint16Array : Float32Array)(desc.width * desc.height * desc.slices * 4);
  const setTexels = (first, second = first, part = 0) => {
    blend(shown.image.data, first.get(place), second.get(place), part, halves);
    uploadAll(renderer, shown);
  };
  const tiles = new Tiles(desc);
  const setBlocks = (texture, blocks, all) => {
    if (half) return setTexels(all), 0;
    const into = new Uint8Array(shown.image.data.buffer), from = all.get(place);
    const bytes = new Uint8Array(from.buffer, from.byteOffset, from.byteLength);
    for (const block of blocks) tiles.forRows(block, (begin, end) => into.set(bytes.subarray(begin, end), begin));
    return uploadBlocks(renderer, shown, desc, tiles, blocks);
  };
  const dispose = grid.dispose.bind(grid);
  Object.defineProperties(grid, {
    blends: {value: true}, setTexels: {value: setTexels}, setBlocks: {value: setBlocks},
    dispose: {configurable: true, value() {
      shown.dispose();
      if (grid.texture === shown) grid.texture = null;
      dispose();
    }},
  });
  grid.texture = shown;
  return grid;
}
