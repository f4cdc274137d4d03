// Volumes that nothing here shades by, as textures for the shaders of an application.
import {Box3, CompressedTexture, DataTexture, Object3D, Vector3} from 'three';

import {boxOf, turnOf} from './axes.js';
import {uploadAll, uploadBlocks} from './partial_upload.js';
import {hasFormat, makeTexture, setImage} from './texture_formats.js';
import {Tiles} from './tilings.js';

/** Layouts whose textures are 3D though their blocks are flat. */
const DEEP = ['bevy', 'three', 'three-float32', 'unity-apv', 'unity-apv-l1', 'unreal-vlm'];

/** The numbers of the textures of a volume that a GPU can have; null: it has none. */
export function plainTextures({firstTexture, textures: number}, textures) {
  const own = Array.from({length: number}, (_, i) => firstTexture + i).filter((at) => hasFormat(textures[at].format));
  return own.length > 0 ? own : null;
}

/** Its textures by name, each as the container has it. */
export class TextureVolume extends Object3D {
  isTextureVolume = true;
  type = 'TextureVolume';
  /** By name. */
  textures = new Map();
  #renderer;
  #own = new Map();  // by number: {texture, desc, tiles}
  #slices = [];      // {texture, number, slice}

  constructor(volume, textures, renderer) {
    super();
    this.#renderer = renderer;
    this.name = volume.name;
    /** The engine's, as engines.h names it; "": it is not said. */
    this.layout = volume.metadata['gicodec:layout'] ?? '';
    const box = boxOf(volume.metadata);
    /** Of what it lights, before it is moved; null: it is not said. */
    this.boundingBox = box && new Box3(new Vector3(...box.least), new Vector3(...box.least).add(new Vector3(...box.size)))
        .applyMatrix4(turnOf(volume.metadata));
    for (const number of plainTextures(volume, textures)) {
      const desc = textures[number];
      const texture = makeTexture(desc, renderer, DEEP.includes(this.layout) || desc.block[2] > 1);
      texture.name = desc.name;
      this.#own.set(number, {texture, desc, tiles: new Tiles(desc)});
      this.textures.set(desc.name, texture);
    }
  }

  /** One slice of a texture as a texture of its own, such as the light map of a layer; it follows the state. */
  slice(name, slice = 0) {
    const [number, {texture, desc}] = [...this.#own].find(([, {desc: {name: called}}]) => called === name) ?? [0, {}];
    if (!texture) throw new RangeError(`there is no texture ${JSON.stringify(name)}; there are ${[...this.textures.keys()].join(', ')}`);
    if (!Number.isInteger(slice) || slice < 0 || slice >= desc.slices) {
      throw new RangeError(`${JSON.stringify(name)} has slices 0 to ${desc.slices - 1}, not ${slice}`);
    }
    const {width, height} = texture.image, {format, type, minFilter, magFilter, internalFormat} = texture;
    const made = texture.isCompressedTexture ? new CompressedTexture([], width, height, format, type)
                                             : new DataTexture(null, width, height, format, type);
    Object.assign(made, {minFilter, magFilter, internalFormat, name: `${name} ${slice}`});
    const one = {texture: made, number, slice};
    this.#slices.push(one);
    made.addEventListener('dispose', () => { this.#slices = this.#slices.filter((other) => other !== one); });
    this.#showSlice(one);
    return made;
  }

  #showSlice({texture, number, slice}) {
    const {image, mipmaps, isCompressedTexture} = this.#own.get(number).texture;
    const all = isCompressedTexture ? mipmaps[0].data : image.data;
    const texels = all.length / this.#own.get(number).desc.slices;
    setImage(texture, all.subarray(slice * texels, (slice + 1) * texels));
    uploadAll(this.#renderer, texture);
  }

  /** Shows textures by number. They stay the volume's. @internal */
  setTexels(all) {
    for (const [number, {texture}] of this.#own) {
      setImage(texture, all.get(number));
      uploadAll(this.#renderer, texture);
    }
    this.#slices.forEach((one) => this.#showSlice(one));
  }

  /** Shows what changed in blocks of a texture. Returns the bytes that went to the GPU at once. @internal */
  setBlocks(number, blocks) {
    const own = this.#own.get(number);
    if (!own) return 0;
    this.#slices.filter((one) => one.number === number).forEach((one) => this.#showSlice(one));
    return uploadBlocks(this.#renderer, own.texture, own.desc, own.tiles, blocks);
  }

  dispose() {
    this.removeFromParent();
    for (const {texture} of [...this.#own.values(), ...this.#slices]) texture.dispose();
  }
}
