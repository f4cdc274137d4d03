// What volumes that light a scene share: their place in the world, and the materials that they light.
import {Light, Matrix4} from 'three';

import {turnOf} from './axes.js';
import {patchMaterial, restoreMaterial} from './material_patch.js';

const LIT = ['isMeshStandardMaterial', 'isMeshLambertMaterial', 'isMeshPhongMaterial', 'isMeshToonMaterial'];
/** Textures of a program that every WebGL 2 has. */
const LEAST_UNITS = 16;
/** Numbers of volumes, which come again: three.js keeps the programs of each. */
const taken = new Set();

function takeNumber() {
  let number = 1;
  while (taken.has(number)) ++number;
  taken.add(number);
  return number;
}

/**
 * Lights what is drawn with it: WebGPURenderer by a node, WebGLRenderer by a change of the materials in its
 * scene, each when it is first seen. Its place in the world is that of the container, moved by its own
 * position, rotation and scale.
 */
export class VolumeLight extends Light {
  /** Whether materials of the scene are changed as they are seen; else those that light() is given. */
  autoLight = true;
  #id = takeNumber();
  #shader;
  #refused = false;
  #materials = new Map();  // that it lights, and what forgets each

  /** `renderer`: null where it is not known, which then is WebGLRenderer. `shader` as patchMaterial() takes it. */
  constructor(volume, renderer, shader) {
    super();
    this.name = volume.name;
    this.autoLight = !renderer?.isWebGPURenderer;
    this.#shader = shader;
    /** @internal */
    this.renderer = renderer;
    /** From the volume's axes and units to three.js's. @internal */
    this.turn = turnOf(volume.metadata);
    /** Of both kinds of shaders, by name. @internal */
    this.uniforms = {FromWorld: {value: new Matrix4()}, Intensity: {}};
    Object.defineProperty(this.uniforms.Intensity, 'value', {enumerable: true, get: () => this.#shownIntensity()});
  }

  updateMatrixWorld(force) {
    super.updateMatrixWorld(force);
    if (!this.uniforms) return;  // of the constructor of Light
    this.uniforms.FromWorld.value.copy(this.matrixWorld).multiply(this.turn).invert();
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
        const most = this.renderer?.capabilities?.maxTextures ?? LEAST_UNITS;
        if (!patchMaterial(one, this.#id, this.#shader, Object.fromEntries(uniforms), most)) {
          this.refuse(most);
          this.#materials.set(one, null);
          continue;
        }
        const forget = () => this.#forget(one);
        one.addEventListener('dispose', forget);
        this.#materials.set(one, forget);
      }
    });
  }

  /** Says once what is left out. @internal */
  refuse(most) {
    if (this.#refused) return;
    this.#refused = true;
    console.error(`GILoader: ${JSON.stringify(this.name)} does not light all: materials have ${most} textures at most, which ` +
                  'those of other volumes fill; remove some of them');
  }

  #forget(material) {
    const forget = this.#materials.get(material);
    this.#materials.delete(material);
    if (!forget) return;
    material.removeEventListener('dispose', forget);
    restoreMaterial(material, this.#id);
  }

  /** 0 unless it is in a scene, and visible with all above it. */
  #shownIntensity() {
    for (let one = this; ; one = one.parent) {
      if (!one.visible) return 0;
      if (one.parent === null) return one === this ? 0 : this.intensity;
    }
  }

  dispose() {
    taken.delete(this.#id);
    for (const material of [...this.#materials.keys()]) this.#forget(material);
    super.dispose();
  }
}
