// A page that loads volumes of engines' layouts: functions that layouts.test.mjs calls.
import * as THREE from 'three';
import {GILoader} from 'gicodec/three';

import {readTexels} from './gpu_texels.js';

const webgpu = new URLSearchParams(location.search).has('webgpu');
const SIZE = 64;
let renderer;

async function begin() {
  renderer = webgpu ? new THREE.WebGPURenderer() : new THREE.WebGLRenderer();
  if (!webgpu) return;
  await renderer.init();
  if (!renderer.backend.isWebGPUBackend) throw new Error('WebGPU is not there');
}

const base64 = (array) => {
  let text = '';
  for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength)) text += String.fromCharCode(byte);
  return btoa(text);
};
const load = (url) => new GILoader().detectSupport(renderer).loadAsync(url);

/** A picture of linear floats: the colour at its middle. */
async function middle(scene, camera) {
  const target = new (webgpu ? THREE.RenderTarget : THREE.WebGLRenderTarget)(SIZE, SIZE, {type: THREE.FloatType, colorSpace: THREE.NoColorSpace});
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  let pixels = new Float32Array(4 * SIZE * SIZE);
  if (webgpu) pixels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, SIZE, SIZE);
  else renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, pixels);
  renderer.setRenderTarget(null);
  target.dispose();
  const at = 4 * (SIZE / 2 * SIZE + SIZE / 2);
  return [...pixels.slice(at, at + 3)];
}

/** What names and textures an object has. */
function texturesOf(object) {
  if (object.isTextureVolume) return Object.fromEntries(object.textures);
  if (object.isAmbientCubeVolume) return {voxels: object.texture};
  return object.isProbeVolume ? {...object.textures} : {grid: object.texture};
}

window.page = {
  /** The texels of a state of all textures, from the GPU. */
  async texels(url, state) {
    const object = await load(url);
    await object.setState(state);
    const found = {};
    for (const [name, texture] of Object.entries(texturesOf(object))) {
      const {bytes, values} = await readTexels(renderer, texture);
      found[name] = {[bytes ? 'bytes' : 'values']: base64(bytes ?? values)};
    }
    const type = object.type, states = object.states.length;
    const box = object.boundingBox && [...object.boundingBox.min.toArray(), ...object.boundingBox.max.toArray()];
    object.dispose();
    return {type, states, box, found, left: renderer.info.memory.textures};
  },

  /** The light on a small white tile at each place, facing that way. */
  async tiles(url, places, move = {}) {
    const scene = new THREE.Scene();
    const object = await load(url);
    if (move.position) object.position.set(...move.position);
    scene.add(object);
    const tile = new THREE.Mesh(new THREE.PlaneGeometry(0.01, 0.01), new (webgpu ? THREE.MeshLambertNodeMaterial : THREE.MeshLambertMaterial)());
    scene.add(tile);
    const camera = new THREE.OrthographicCamera(-0.004, 0.004, 0.004, -0.004, 0.001, 1);
    const colors = [];
    for (const [at, normal] of places) {
      const from = new THREE.Vector3(...at), to = new THREE.Vector3(...normal);
      camera.up.set(...(Math.abs(normal[1]) > 0.9 ? [0, 0, 1] : [0, 1, 0]));
      tile.position.copy(from);
      tile.lookAt(from.clone().add(to));
      camera.position.copy(from).addScaledVector(to, 0.1);
      camera.lookAt(from);
      colors.push(await middle(scene, camera));
    }
    const {min, max} = object.boundingBox ?? new THREE.Box3();
    const box = [...min.toArray(), ...max.toArray()];
    object.dispose();
    object.removeFromParent();
    tile.geometry.dispose();
    return {colors, box};
  },

  /** The light of a slice of a light map on a tile of which it is all. */
  async lightMap(url, name, slices, state) {
    const object = await load(url);
    const material = new (webgpu ? THREE.MeshLambertNodeMaterial : THREE.MeshLambertMaterial)({lightMapIntensity: Math.PI});
    const scene = new THREE.Scene();
    scene.add(new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material));
    const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
    camera.position.z = 1;
    const colors = [];
    for (const slice of slices) {
      material.lightMap?.dispose();
      material.lightMap = object.slice(name, slice);
      material.needsUpdate = true;
      colors.push(await middle(scene, camera));
    }
    await object.setState(state);
    colors.push(await middle(scene, camera));
    const refused = (() => { try { object.slice(name, 1e6); } catch ({message}) { return message; } })();
    material.dispose();
    object.dispose();
    return {colors, refused};
  },

  /** Programs of the renderer after each of some loads of a file, into the same scene. */
  async programs(url, times) {
    const scene = new THREE.Scene();
    scene.add(new THREE.Mesh(new THREE.PlaneGeometry(), new THREE.MeshLambertMaterial()));
    const camera = new THREE.OrthographicCamera();
    const counts = [];
    for (let i = 0; i < times; ++i) {
      const object = await load(url);
      scene.add(object);
      await middle(scene, camera);
      object.removeFromParent();
      object.dispose();
      await middle(scene, camera);
      counts.push(renderer.info.programs.length);
    }
    return counts;
  },

  /** What a file becomes: the type of each volume by name. */
  async types(url) {
    const object = await load(url);
    const all = object.isGroup ? object.children : [object];
    const types = Object.fromEntries(all.map(({name, type}) => [name, type]));
    object.dispose();
    return types;
  },

  /** The texels of a texture of three's own over these bytes of compressed blocks. */
  async compressed(data, width, height, format) {
    const bytes = Uint8Array.from(atob(data), (one) => one.charCodeAt(0));
    const texture = new THREE.CompressedArrayTexture([{data: bytes, width, height}], width, height, 1, THREE[format], THREE.UnsignedByteType);
    texture.needsUpdate = true;
    const {bytes: all, values} = await readTexels(renderer, texture);
    texture.dispose();
    return {[all ? 'bytes' : 'values']: base64(all ?? values)};
  },
  compresses: () => (webgpu ? renderer.hasFeature('texture-compression-bc')
                            : renderer.extensions.has('EXT_texture_compression_bptc')),
};
begin().then(() => { window.ready = true; }, (error) => { window.ready = `${error.stack}`; });
