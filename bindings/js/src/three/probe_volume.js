// Volumes of kind probes (DDGI): irradiance and visibility by octahedral direction, as a light.
import {
  Box3, DataArrayTexture, FloatType, Light, LinearFilter, Matrix3, Matrix4, NearestFilter, RedFormat, UnsignedByteType, Vector3,
} from 'three';

import {turnOf} from './axes.js';
import {uploadAll, uploadBlocks} from './partial_upload.js';
import {patchMaterial, restoreMaterial} from './probe_shader.js';
import {addStates} from './states.js';
import {filtersFloat, formatOf} from './texture_formats.js';
import {forRows, tilingOf} from './tilings.js';

const COLORS = ['A2R10G10B10_UNORM_PACK32', 'A2B10G10R10_UNORM_PACK32', 'R8G8B8A8_UNORM', 'R16G16B16A16_SFLOAT',
                'R32G32B32A32_SFLOAT', 'B10G11R11_UFLOAT_PACK32', 'E5B9G9R9_UFLOAT_PACK32'];
const VISIBILITIES = ['R16G16_SFLOAT', 'R32G32_SFLOAT'];
const LIT = ['isMeshStandardMaterial', 'isMeshLambertMaterial', 'isMeshPhongMaterial', 'isMeshToonMaterial'];
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

/** Whether colour is radiance rather than its fifth root. */
function isLinear(volume, texture) {
  const said = texture.metadata['attribute:gicodec:encoding'];
  if (said) return said.endsWith('linear');
  if ((volume.metadata['gicodec:layout'] ?? '').startsWith('rtxgi')) return false;
  return !texture.format.includes('UNORM');
}

function arrayTexture({width, height, slices, format}, renderer) {
  const {format: pixels, type, words} = formatOf(format);
  const texture = Object.assign(new DataArrayTexture(null, width, height, slices), {format: pixels, type});
  const filtered = !words && (type !== FloatType || filtersFloat(renderer));
  texture.minFilter = texture.magFilter = filtered ? LinearFilter : NearestFilter;
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
  #renderer;
  #materials = new Map();  // that it lights, and what forgets each

  /** @internal */
  static async make(states, volume, textures, renderer) {
    const light = new ProbeVolume(volume, textures, renderer);
    await addStates(light, states, (frames) => light.setTexels(frames), {blends: false});
    return light;
  }

  /** Lets a WebGPURenderer draw with volumes. @internal */
  static async useNodes(renderer) {
    const {ProbeVolumeNode} = await import('gicodec:entry/three_nodes');
    if (ProbeVolume.registerNode) ProbeVolume.registerNode(ProbeVolumeNode);
    else renderer.library.addLight(ProbeVolumeNode, ProbeVolume);  // before r187
  }

  /** `renderer`: null where it is not known, which then is WebGLRenderer. */
  constructor(volume, textures, renderer) {
    super();
    this.#renderer = renderer;
    this.autoLight = !renderer?.isWebGPURenderer;
    const places = probeTextures(volume, textures);
    if (!volume.geometry) {
      throw new RangeError(`${JSON.stringify(volume.name)} does not say where its probes stand: attributes ` +
                           'gicodec:origin and gicodec:spacing of dumps do');
    }
    const {grid} = volume.geometry;
    const [color, visibility] = [textures[places.color], textures[places.visibility]];
    this.name = volume.name;
    this.#places = places;
    /** Of the textures, as the container has them. @internal */
    this.descs = {color, visibility};
    /** Probes along each axis. */
    this.grid = grid;
    /** When each probe changed last, as performance.now() says it. */
    this.changedAt = new Float64Array(grid[0] * grid[1] * grid[2]).fill(-Infinity);
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
      Color: {value: arrayTexture(color, renderer)}, Visibility: {value: arrayTexture(visibility, renderer)}, Active: {value: active},
      FromWorld: {value: new Matrix4()}, Origin: {value: new Vector3()}, Spacing: {value: new Vector3()},
      Grid: {value: new Vector3(...grid)}, Scroll: {value: new Vector3()},
      ColorTile: {value: ofColor.tile}, ColorSize: {value: ofColor.size},
      VisibilityTile: {value: ofVisibility.tile}, VisibilitySize: {value: ofVisibility.size}, Intensity: {},
    };
    Object.defineProperty(this.uniforms.Intensity, 'value', {enumerable: true, get: () => this.#shownIntensity()});
    /** From the first probe to the last, before the volume is moved. */
    this.boundingBox = new Box3();
    this.setGeometry(volume.geometry);
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
    if (!this.autoLight || !this.parent) return;
    let root = this.parent;
    while (root.parent) root = root.parent;
    this.light(root);
  }

  /** Lets the materials of an object and of all below it be lit by this, in WebGLRenderer. */
  light(object) {
    object.traverse(({material}) => {
      for (const one of Array.isArray(material) ? material : [material]) {
        if (!one || this.#materials.has(one) || !LIT.some((kind) => one[kind])) continue;
        const uniforms = Object.entries(this.uniforms).map(([name, value]) => [`gi${this.#id}${name}`, value]);
        patchMaterial(one, this.#id, this.kind, Object.fromEntries(uniforms));
        const forget = () => this.#forget(one);
        one.addEventListener('dispose', forget);
        this.#materials.set(one, forget);
      }
    });
  }

  #forget(material) {
    material.removeEventListener('dispose', this.#materials.get(material));
    this.#materials.delete(material);
    restoreMaterial(material, this.#id);
  }

  /** 0 unless it is in a scene, and visible with all above it. */
  #shownIntensity() {
    for (let one = this; ; one = one.parent) {
      if (!one.visible) return 0;
      if (one.parent === null) return one === this ? 0 : this.intensity;
    }
  }

  /** Whether a probe holds anything, by its number, x + nx·(y + ny·z). */
  isActive(probe) {
    return this.uniforms.Active.value.image.data[probe] !== 0;
  }

  /** Where a probe stands, before the volume is moved. */
  probePosition(probe, target = new Vector3()) {
    const [nx, ny] = this.grid;
    const block = [probe % nx, Math.floor(probe / nx) % ny, Math.floor(probe / (nx * ny))];
    const {Origin, Spacing, Scroll} = this.uniforms;
    const cell = block.map((at, axis) => {
      const scroll = Scroll.value.getComponent(axis), side = this.grid[axis];
      return scroll + ((at - scroll) % side + side) % side;
    });
    return target.set(...cell).multiply(Spacing.value).add(Origin.value).applyMatrix4(this.#turn);
  }

  /** Shows textures by number, all of them. They stay the light's. @internal */
  setTexels(all) {
    const set = (texture, texels) => {
      texture.image.data = texels;
      uploadAll(this.#renderer, texture);
    };
    set(this.uniforms.Color.value, all.get(this.#places.color));
    set(this.uniforms.Visibility.value, all.get(this.#places.visibility));
    this.#settle(Array.from({length: this.descs.visibility.blocks}, (_, block) => block));
    this.changedAt.fill(performance.now());
  }

  /** Shows what changed in blocks of a texture. Returns the bytes that went to the GPU at once. @internal */
  setBlocks(texture, blocks) {
    const name = Object.keys(this.#places).find((one) => this.#places[one] === texture);
    if (!name) return 0;
    const now = performance.now();
    for (const block of blocks) this.changedAt[block] = now;
    if (name === 'visibility') this.#settle(blocks);
    return uploadBlocks(this.#renderer, this.textures[name], this.descs[name], blocks);
  }

  /** A probe is active unless its block of visibility is zero. */
  #settle(blocks) {
    const {image: {data}} = this.uniforms.Visibility.value, active = this.uniforms.Active.value;
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    for (const block of blocks) {
      let any = 0;
      forRows(this.descs.visibility, block, (first, end) => {
        for (let i = first; i < end && any === 0; ++i) any |= bytes[i];
      });
      active.image.data[block] = any === 0 ? 0 : 255;
    }
    uploadAll(this.#renderer, active);
  }

  /** Says where the probes stand, for a volume that scrolls. @internal */
  setGeometry({origin, spacing, scroll}) {
    this.uniforms.Origin.value.set(...origin);
    this.uniforms.Spacing.value.set(...spacing);
    this.uniforms.Scroll.value.set(...scroll);
    const corner = (cell) => new Vector3(...origin.map((at, axis) => at + (scroll[axis] + cell(axis)) * spacing[axis]));
    this.boundingBox.set(corner(() => 0), corner((axis) => this.grid[axis] - 1)).applyMatrix4(this.#turn);
  }

  dispose() {
    for (const material of [...this.#materials.keys()]) this.#forget(material);
    for (const name of ['Color', 'Visibility', 'Active']) this.uniforms[name].value.dispose();
    super.dispose();
  }
}
