// Containers of three.js's own layout (engines.h, three_volume) as LightProbeGrid.
import {Data3DTexture, DataUtils, FloatType, HalfFloatType, LinearFilter, RGBAFormat} from 'three';

import {AXES, unitOf} from './axes.js';
import {uploadAll} from './partial_upload.js';
import {addStates} from './states.js';

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

/** Least corner and size of the box that a volume lights, in metres. */
function boxOf(metadata, resolution) {
  const bounds = (metadata['gicodec:bounds'] ?? '').split(' ').map(Number);
  const unit = unitOf(metadata);
  if (bounds.length !== 6 || !bounds.every(Number.isFinite) || ![0, 1, 2].every((axis) => bounds[axis] < bounds[axis + 3])) {
    console.warn('GILoader: the container does not say which box its grid lights: a metre for each probe is ' +
                 'taken. gicodec encode --bounds says it.');
    return {least: resolution.map((side) => -side / 2), size: resolution};
  }
  return {least: bounds.slice(0, 3).map((at) => at * unit),
          size: bounds.slice(3).map((at, axis) => (at - bounds[axis]) * unit)};
}

/** A 3D texture over texels, which it copies. */
function makeTexture([width, height], slices, Type, type) {
  const texture = new Data3DTexture(new Type(width * height * slices * 4), width, height, slices);
  texture.format = RGBAFormat;
  texture.type = type;
  texture.minFilter = texture.magFilter = LinearFilter;
  return texture;
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

/** A LightProbeGrid of a volume, with states. `Grid` is its class, `half` turns float to half. */
export async function makeProbeGrid(states, volume, texture, place, {Grid, half, renderer}) {
  const axes = volume.metadata['gicodec:axes'] ?? AXES;
  if (axes !== AXES) {
    throw new RangeError(`the axes of ${JSON.stringify(volume.name)} are ${axes}, and a LightProbeGrid's are ${AXES}: ` +
                         'bake it with these');
  }
  const resolution = resolutionOf(texture);
  const {least, size} = boxOf(volume.metadata, resolution);
  const grid = new Grid(...size, ...resolution);
  grid.name = volume.name;
  grid.position.set(...least.map((at, axis) => at + size[axis] / 2));
  grid.updateBoundingBox();

  const halves = half || texture.ArrayType === Uint16Array;
  const shown = makeTexture(resolution, texture.slices, halves ? Uint16Array : Float32Array,
                            halves ? HalfFloatType : FloatType);
  await addStates(grid, states, (first, second, part) => {
    blend(shown.image.data, first.get(place), second.get(place), part, halves);
    uploadAll(renderer, shown);
  }, {free() {
    shown.dispose();
    if (grid.texture === shown) grid.texture = null;
  }});
  grid.texture = shown;
  return grid;
}
