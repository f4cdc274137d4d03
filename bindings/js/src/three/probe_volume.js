// Volumes of kind probes (DDGI): irradiance and visibility by octahedral direction, as a light.
import {Box3, DataArrayTexture, Matrix3, RedFormat, UnsignedByteType, Vector3} from 'three';

import {uploadAll, uploadBlocks} from './partial_upload.js';
import {probeFunctions} from './probe_shader.js';
import {formatOf, makeTexture, setImage} from './texture_formats.js';
import {Tiles} from './tilings.js';
import {VolumeLight} from './volume_light.js';

const COLORS = ['A2R10G10B10_UNORM_PACK32', 'A2B10G10R10_UNORM_PACK32', 'R8G8B8A8_UNORM', 'R16G16B16A16_SFLOAT',
                'R32G32B32A32_SFLOAT', 'B10G11R11_UFLOAT_PACK32', 'E5B9G9R9_UFLOAT_PACK32'];
const VISIBILITIES = ['R16G16_SFLOAT', 'R32G32_SFLOAT'];

/** The numbers of a volume's irradiance and visibility among textures; null: it has none. */
export function probeTextures({kind, firstTexture, textures: number}, textures) {
  if (kind !== 'probes') return null;
  const find = (formats) => {
    const own = textures.slice(firstTexture, firstTexture + number);
    const at = own.findIndex((one) => formats.includes(one.format) && one.guardBand === 1 && one.tiling !== 'blocks');
    return at < 0 ? null : firstTexture + at;
  };
  const [color, visibility] = [find(COLORS), find(VISIBILITIES)];
  return color === null || visibility === null ? null : [color, visibility];
}

/** Whether colour is radiance rather than its fifth root. */
function isLinear(volume, texture) {
  const said = texture.metadata['attribute:gicodec:encoding'];
  if (said) return said.endsWith('linear');
  if ((volume.metadata['gicodec:layout'] ?? '').startsWith('rtxgi')) return false;
  return !texture.format.includes('UNORM');
}

/** Lights what is drawn with it, with visibility. */
export class ProbeVolume extends VolumeLight {
  isProbeVolume = true;
  type = 'ProbeVolume';
  #shown;  // {name, number, desc, tiles} of both textures

  constructor(volume, textures, renderer) {
    if (!volume.geometry) {
      throw new RangeError(`${JSON.stringify(volume.name)} does not say where its probes stand: attributes ` +
                           'gicodec:origin and gicodec:spacing of dumps do');
    }
    const [color, visibility] = probeTextures(volume, textures);
    /** What shaders differ in. */
    const kind = {words: formatOf(textures[color].format).words ?? null, linear: isLinear(volume, textures[color])};
    super(volume, renderer, {key: `probes ${kind.words} ${kind.linear}`, samplers: 3, functions: (id) => probeFunctions(id, kind)});
    /** @internal */
    this.kind = kind;
    this.#shown = [['Color', color], ['Visibility', visibility]].map(([name, number]) => (
        {name, number, desc: textures[number], tiles: new Tiles(textures[number])}));
    const {grid} = volume.geometry;
    /** Probes along each axis. */
    this.grid = grid;
    /** When each probe changed last, as performance.now() says it. */
    this.changedAt = new Float64Array(grid[0] * grid[1] * grid[2]).fill(-Infinity);
    const active = new DataArrayTexture(new Uint8Array(grid[0] * grid[1] * grid[2]), ...grid);
    Object.assign(active, {format: RedFormat, type: UnsignedByteType});
    for (const {name, desc, tiles: {steps: [x, y, z], size, offset}} of this.#shown) {
      this.uniforms[name] = {value: makeTexture(desc, renderer)};
      this.uniforms[`${name}Tile`] = {value: new Matrix3(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])};
      this.uniforms[`${name}Size`] = {value: new Vector3(size[0], offset, desc.block[0])};
    }
    Object.assign(this.uniforms, {
      Active: {value: active}, Origin: {value: new Vector3()}, Spacing: {value: new Vector3()},
      Grid: {value: new Vector3(...grid)}, Scroll: {value: new Vector3()},
    });
    /** From the first probe to the last, before the volume is moved. */
    this.boundingBox = new Box3();
    this.setGeometry(volume.geometry);
    this.updateMatrixWorld(true);
  }

  /** The textures on the GPU: {color, visibility}, texel for texel those of the container. */
  get textures() {
    return {color: this.uniforms.Color.value, visibility: this.uniforms.Visibility.value};
  }

  /** The irradiance: {desc, tiles}. @internal */
  get irradiance() {
    return this.#shown[0];
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
    return target.set(...cell).multiply(Spacing.value).add(Origin.value).applyMatrix4(this.turn);
  }

  /** Shows textures by number. They stay the light's. @internal */
  setTexels(all) {
    for (const {name, number} of this.#shown) {
      setImage(this.uniforms[name].value, all.get(number));
      uploadAll(this.renderer, this.uniforms[name].value);
    }
    this.#settle(Array.from({length: this.#shown[1].desc.blocks}, (_, block) => block));
    this.changedAt.fill(performance.now());
  }

  /** Shows what changed in blocks of a texture. Returns the bytes that went to the GPU at once. @internal */
  setBlocks(texture, blocks) {
    const found = this.#shown.find(({number}) => number === texture);
    if (!found) return 0;
    const now = performance.now();
    for (const block of blocks) this.changedAt[block] = now;
    if (found.name === 'Visibility') this.#settle(blocks);
    return uploadBlocks(this.renderer, this.uniforms[found.name].value, found.desc, found.tiles, blocks);
  }

  /** A probe is active unless its block of visibility is zero. */
  #settle(blocks) {
    const {image: {data}} = this.uniforms.Visibility.value, active = this.uniforms.Active.value;
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    for (const block of blocks) {
      let any = 0;
      this.#shown[1].tiles.forRows(block, (first, end) => {
        for (let i = first; i < end && any === 0; ++i) any |= bytes[i];
      });
      active.image.data[block] = any === 0 ? 0 : 255;
    }
    uploadAll(this.renderer, active);
  }

  /** Says where the probes stand, for a volume that scrolls. @internal */
  setGeometry({origin, spacing, scroll}) {
    this.uniforms.Origin.value.set(...origin);
    this.uniforms.Spacing.value.set(...spacing);
    this.uniforms.Scroll.value.set(...scroll);
    const corner = (cell) => new Vector3(...origin.map((at, axis) => at + (scroll[axis] + cell(axis)) * spacing[axis]));
    this.boundingBox.set(corner(() => 0), corner((axis) => this.grid[axis] - 1)).applyMatrix4(this.turn);
  }

  dispose() {
    for (const name of ['Color', 'Visibility', 'Active']) this.uniforms[name].value.dispose();
    super.dispose();
  }
}
