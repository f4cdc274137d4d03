// Volumes of ambient cubes in Bevy's layout (engines.h, bevy_volume), as a light.
import {Box3, Vector3} from 'three';

import {boxOrCells} from './axes.js';
import {cubeShader} from './cube_shader.js';
import {uploadAll, uploadBlocks} from './partial_upload.js';
import {isFiltered, makeTexture, setImage} from './texture_formats.js';
import {Tiles} from './tilings.js';
import {VolumeLight} from './volume_light.js';

/** The number of the texture of such a volume; null: it is no such volume. */
export function cubeTextures({metadata, firstTexture}, textures) {
  const {format, height, slices} = textures[firstTexture] ?? {};
  return metadata['gicodec:layout'] === 'bevy' && isFiltered(format) && height % 2 === 0 && slices % 3 === 0 ? [firstTexture] : null;
}

/** Lights what is in its box, as Bevy does: six colours in each voxel, three of them by the normal. */
export class AmbientCubeVolume extends VolumeLight {
  isAmbientCubeVolume = true;
  type = 'AmbientCubeVolume';
  #place;
  #desc;
  #tiles;

  constructor(volume, textures, renderer) {
    super(volume, renderer, cubeShader);
    this.#place = volume.firstTexture;
    this.#desc = textures[this.#place];
    this.#tiles = new Tiles(this.#desc);
    const {width, height, slices} = this.#desc;
    /** Voxels along each axis. */
    this.grid = [width, height / 2, slices / 3];
    const {least, size} = boxOrCells(volume.metadata, this.grid);
    Object.assign(this.uniforms, {
      Cubes: {value: makeTexture(this.#desc, renderer, true)},
      Least: {value: new Vector3(...least)}, Size: {value: new Vector3(...size)},
    });
    const {Least, Size} = this.uniforms;
    /** Of what it lights, before the volume is moved. */
    this.boundingBox = new Box3(Least.value.clone(), Least.value.clone().add(Size.value)).applyMatrix4(this.turn);
    this.updateMatrixWorld(true);
  }

  /** The texture on the GPU, texel for texel that of the container. */
  get texture() {
    return this.uniforms.Cubes.value;
  }

  /** Shows textures by number. They stay the light's. @internal */
  setTexels(all) {
    setImage(this.texture, all.get(this.#place));
    uploadAll(this.renderer, this.texture);
  }

  /** Shows what changed in blocks of the texture. Returns the bytes that went to the GPU at once. @internal */
  setBlocks(texture, blocks) {
    return uploadBlocks(this.renderer, this.texture, this.#desc, this.#tiles, blocks);
  }

  dispose() {
    this.texture.dispose();
    super.dispose();
  }
}
