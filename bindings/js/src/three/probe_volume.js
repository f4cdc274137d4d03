// Volumes of kind probes (DDGI): irradiance and visibility by octahedral direction, as a light.
import {
  Box3, DataArrayTexture, Light, LinearFilter, Matrix3, Matrix4, NearestFilter, RedFormat, UnsignedByteType, Vector3,
} from 'three';

import {patchMaterial} from './probe_shader.js';
import {addStates} from './states.js';
import {formatOf} from './texture_formats.js';
import {tilingOf} from './tilings.js';

const COLORS = ['A2R10G10B10_UNORM_PACK32', 'A2B10G10R10_UNORM_PACK32', 'R8G8B8A8_UNORM', 'R16G16B16A16_SFLOAT',
                'R32G32B32A32_SFLOAT', 'B10G11R11_UFLOAT_PACK32', 'E5B9G9R9_UFLOAT_PACK32'];
const VISIBILITIES = ['R16G16_SFLOAT', 'R32G32_SFLOAT'];
const LIT = ['isMeshStandardMaterial', 'isMeshLambertMaterial', 'isMeshPhongMaterial', 'isMeshToonMaterial'];
const DIRECTIONS = {right: [1, 0, 0], left: [-1, 0, 0], up: [0, 1, 0], down: [0, -1, 0], back: [0, 0, 1], forward: [0, 0, -1]};
let count = 0;

/** The places of a volume's irradiance and visibility among a container's textures; null: it has none. */
export function probeTextures({kind, firstTexture, textures: number}, textures) {
  if (kind !== 'probes') return null;
  const find = (formats) => {
    const own = textures.slice(firstTexture, firstTexture + number);
    const at = own.findIndex((one) => formats.includes(one.format) && one.guardBand === 1 && tilingOf(one));
    return at < 0 ? null : firstTexture + at;
  };
  const [color, visibility] = [find(COLORS), find(VISIBILITIES)];
  return color === null || visibility === null ? null : {color, visibility};
}

/** From a volume's axes and units to three.js's. */
function turnOf(metadata) {
  const words = (metadata['gicodec:axes'] ?? 'right up back').split(' ');
  const axes = words.map((word) => DIRECTIONS[word]);
  const unit = Number(metadata['gicodec:unit'] ?? 1) || 1;
  const whole = axes.length === 3 && axes.every(Boolean) && [0, 1, 2].every((at) => axes.some((axis) => axis[at] !== 0));
  const [x, y, z] = (whole ? axes : ['right', 'up', 'back'].map((word) => DIRECTIONS[word]))
      .map((axis) => new Vector3(...axis).multiplyScalar(unit));
  return new Matrix4().makeBasis(x, y, z);
}

/** Whether colour is radiance rather than its fifth root. */
function isLinear(volume, texture) {
  const said = texture.metadata['attribute:gicodec:encoding'];
  if (said) return said.endsWith('linear');
  if ((volume.metadata['gicodec:layout'] ?? '').startsWith('rtxgi')) return false;
  return !texture.format.includes('UNORM');
}

function arrayTexture({width, height, slices, format}) {
  const {format: pixels, type, words} = formatOf(format);
  const texture = Object.assign(new DataArrayTexture(null, width, height, slices), {format: pixels, type});
  texture.minFilter = texture.magFilter = words ? NearestFilter : LinearFilter;
  return texture;
}

/**
 * Lights what is drawn with the volume: WebGPURenderer by a node, WebGLRenderer by a change of the
 * materials in its scene, each when it is first seen. Its place in the world is that of the container,
 * moved by its own position, rotation and scale.
 */
export class ProbeVolume extends Light {
  isProbeVolume = true;
  type = 'ProbeVolume';
  /** Whether materials of the scene are changed as they are seen; else those that light() is given. */
  autoLight = true;
  #id = ++count;
  #turn;
  #places;
  #visibility;
  #patched = new Map();

  /** @internal */
  static async make(states, volume, textures, {webgpu}) {
    const light = new ProbeVolume(volume, textures);
    light.autoLight = !webgpu;
    await addStates(light, states, (frames) => light.#show(frames), () => light.#free());
    return light;
  }

  constructor(volume, textures) {
    super();
    const places = probeTextures(volume, textures);
    if (!volume.geometry) {
      throw new RangeError(`${JSON.stringify(volume.name)} does not say where its probes stand: attributes ` +
                           'gicodec:origin and gicodec:spacing of dumps do');
    }
    const {grid, origin, spacing, scroll} = volume.geometry;
    const [color, visibility] = [textures[places.color], textures[places.visibility]];
    this.name = volume.name;
    this.#places = places;
    this.#visibility = visibility;
    this.#turn = turnOf(volume.metadata);
    /** What shaders differ in. */
    this.kind = {words: formatOf(color.format).words, linear: isLinear(volume, color)};
    const active = new DataArrayTexture(new Uint8Array(grid[0] * grid[1] * grid[2]), ...grid);
    Object.assign(active, {format: RedFormat, type: UnsignedByteType});
    const tile = (texture) => {
      const {steps: [x, y, z], stride, offset} = tilingOf(texture);
      return {tile: new Matrix3(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]),
              size: new Vector3(stride, offset, texture.block[0])};
    };
    const [ofColor, ofVisibility] = [tile(color), tile(visibility)];
    /** Of both kinds of shaders, by name. */
    this.uniforms = {
      Color: {value: arrayTexture(color)}, Visibility: {value: arrayTexture(visibility)}, Active: {value: active},
      FromWorld: {value: new Matrix4()}, Origin: {value: new Vector3(...origin)}, Spacing: {value: new Vector3(...spacing)},
      Grid: {value: new Vector3(...grid)}, Scroll: {value: new Vector3(...scroll)},
      ColorTile: {value: ofColor.tile}, ColorSize: {value: ofColor.size},
      VisibilityTile: {value: ofVisibility.tile}, VisibilitySize: {value: ofVisibility.size}, Intensity: {value: 1},
    };
    const last = origin.map((at, axis) => at + (scroll[axis] + grid[axis] - 1) * spacing[axis]);
    const first = origin.map((at, axis) => at + scroll[axis] * spacing[axis]);
    /** From the first probe to the last, before the volume is moved. */
    this.boundingBox = new Box3(new Vector3(...first), new Vector3(...last)).applyMatrix4(this.#turn);
    this.updateMatrixWorld(true);
  }

  /** The textures on the GPU: {color, visibility}, texel for texel those of the container. */
  get textures() {
    return {color: this.uniforms.Color.value, visibility: this.uniforms.Visibility.value};
  }

  updateMatrixWorld(force) {
    super.updateMatrixWorld(force);
    if (!this.uniforms) return;  // of the constructor of Light
    this.uniforms.FromWorld.value.copy(this.matrixWorld).multiply(this.#turn).invert();
    this.uniforms.Intensity.value = this.visible ? this.intensity : 0;
    if (!this.autoLight || !this.parent) return;
    let root = this.parent;
    while (root.parent) root = root.parent;
    this.light(root);
  }

  /** Lets the materials of an object and of all below it be lit by this, in WebGLRenderer. */
  light(object) {
    object.traverse(({material}) => {
      for (const one of Array.isArray(material) ? material : [material]) {
        if (!one || this.#patched.has(one) || !LIT.some((kind) => one[kind])) continue;
        const uniforms = Object.entries(this.uniforms).map(([name, value]) => [`gi${this.#id}${name}`, value]);
        this.#patched.set(one, patchMaterial(one, this.#id, this.kind, Object.fromEntries(uniforms)));
      }
    });
  }

  #show(frames) {
    const set = (texture, texels) => {
      texture.image.data = texels;
      texture.needsUpdate = true;
    };
    set(this.uniforms.Color.value, frames.get(this.#places.color));
    const seen = frames.get(this.#places.visibility);
    set(this.uniforms.Visibility.value, seen);
    activeProbes(this.#visibility, seen, this.uniforms.Active.value.image.data);
    this.uniforms.Active.value.needsUpdate = true;
  }

  #free() {
    for (const restore of this.#patched.values()) restore();
    this.#patched.clear();
    for (const name of ['Color', 'Visibility', 'Active']) this.uniforms[name].value.dispose();
  }
}

/** A probe is active unless its block of visibility is zero. */
function activeProbes(desc, texels, active) {
  const {steps, stride, offset} = tilingOf(desc);
  const {grid: [nx, ny, nz], block: [core], width, height} = desc;
  const words = new Uint32Array(texels.buffer, texels.byteOffset, texels.byteLength >> 2);
  const perTexel = words.length / (width * height * desc.slices);
  const at = (place, x, y, z) => steps[0][place] * x + steps[1][place] * y + steps[2][place] * z;
  for (let z = 0, probe = 0; z < nz; ++z) {
    for (let y = 0; y < ny; ++y) {
      for (let x = 0; x < nx; ++x, ++probe) {
        const left = at(0, x, y, z) * stride + offset;
        let top = at(2, x, y, z) * height + at(1, x, y, z) * stride + offset;
        let any = 0;
        for (let end = top + core; top < end && any === 0; ++top) {
          const first = (top * width + left) * perTexel;
          for (let i = first; i < first + core * perTexel; ++i) any |= words[i];
        }
        active[probe] = any === 0 ? 0 : 255;
      }
    }
  }
}
