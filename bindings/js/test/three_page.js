// A page that bakes, saves and loads light probe grids: functions that three.test.mjs calls.
import * as THREE from 'three';
import {GILoader, captureLightProbeGrid, saveLightProbeGrid} from 'gicodec/three';

const webgpu = new URLSearchParams(location.search).has('webgpu');
const GRID = [5, 3, 4], BOX = [8, 4, 6], SIZE = 128;
let renderer, scene, camera, lamp, baked;
const said = [];
for (const level of ['info', 'warn', 'error']) {
  const usual = console[level].bind(console);
  console[level] = (...values) => (said.push(`${level}: ${values.join(' ')}`), usual(...values));
}

function wall(color, x, y, z, width, height, depth) {
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(width, height, depth),
                              new (webgpu ? THREE.MeshStandardNodeMaterial : THREE.MeshStandardMaterial)({color}));
  mesh.position.set(x, y, z);
  scene.add(mesh);
}

async function begin() {
  const canvas = document.createElement('canvas');
  document.body.append(canvas);
  renderer = webgpu ? new THREE.WebGPURenderer({canvas}) : new THREE.WebGLRenderer({canvas, preserveDrawingBuffer: true});
  if (webgpu) {
    await renderer.init();
    if (!renderer.backend.isWebGPUBackend) throw new Error('WebGPU is not there');
  }
  renderer.setSize(SIZE, SIZE, false);
  scene = new THREE.Scene();
  camera = new THREE.PerspectiveCamera(60, 1, 0.1, 50);
  camera.position.set(0, 2, 2.9);
  camera.lookAt(0, 1.5, -3);
  wall(0xffffff, 0, -0.1, 0, 8, 0.2, 6);
  wall(0xff4020, -4, 2, 0, 0.2, 4, 6);
  wall(0x20a0ff, 4, 2, 0, 0.2, 4, 6);
  wall(0xffffff, 0, 2, -3, 8, 4, 0.2);
  wall(0xd0d0d0, 0.8, 0.5, -1, 1, 1, 1);
  lamp = new THREE.PointLight(0xffffff, 30);
  lamp.position.set(0.5, 3, 0.5);
  scene.add(lamp);
  const name = webgpu ? 'LightProbeGrid' : 'LightProbeGridWebGL';  // which the other build cannot import
  baked = new (await import(`three/addons/lighting/${name}.js`))[name](...BOX, ...GRID);
  baked.position.set(0, 2, 0);
  scene.add(baked);
  bake();
}

function bake() {
  baked.bake(renderer, scene, {cubemapSize: 8, bounces: 1});
}

/** The light of a grid alone, as a picture. */
async function picture(grid) {
  lamp.visible = false;
  baked.removeFromParent();
  if (grid) scene.add(grid);
  const target = new THREE.RenderTarget(SIZE, SIZE);
  const old = renderer.getRenderTarget();
  renderer.setRenderTarget(webgpu ? target : null);
  renderer.render(scene, camera);
  let pixels = new Uint8Array(4 * SIZE * SIZE);
  if (webgpu) pixels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, SIZE, SIZE);
  else renderer.getContext().readPixels(0, 0, SIZE, SIZE, 6408, 5121, pixels);
  renderer.setRenderTarget(old);
  target.dispose();
  grid?.removeFromParent();
  scene.add(baked);
  lamp.visible = true;
  return pixels;
}

const differences = (a, b) => a.reduce((sum, value, i) => sum + (value !== b[i]), Math.abs(a.length - b.length));
const words = (array) => new Uint16Array(array.buffer, array.byteOffset, array.byteLength / 2);

/** The texels of a loaded grid, from the GPU. */
async function texelsOnGpu(grid) {
  await picture(grid);
  const {image} = grid.texture, {data} = image;
  image.data = null;
  try {
    return (await captureLightProbeGrid(renderer, grid)).texels;
  } finally {
    image.data = data;
  }
}

const loader = () => new GILoader().detectSupport(renderer);
const base64 = (array) => {
  let text = '';
  for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength)) text += String.fromCharCode(byte);
  return btoa(text);
};

window.page = {
  begin, said,

  /** A baked grid, saved and loaded: what differs. */
  async roundTrip() {
    const {texels, bounds} = await captureLightProbeGrid(renderer, baked);
    const bytes = await saveLightProbeGrid(renderer, baked);
    const grid = await loader().parse(bytes);
    const result = {
      type: texels.constructor.name, texels: texels.length, bytes: bytes.length, nonzero: texels.filter(Boolean).length,
      texelsDiffer: differences(words(texels), words(await texelsOnGpu(grid))),
      picturesDiffer: differences(await picture(baked), await picture(grid)),
      darkDiffer: differences(await picture(null), await picture(grid)),
      bounds, box: [...grid.boundingBox.min.toArray(), ...grid.boundingBox.max.toArray()],
      resolution: grid.resolution.toArray(), resolutionBefore: GRID, file: base64(bytes),
    };
    grid.dispose();
    return result;
  },

  /** A file of three states with times and a name. */
  async states() {
    const captured = [];
    for (const [x, intensity] of [[-2, 30], [2, 60], [0, 5]]) {
      lamp.position.x = x;
      lamp.intensity = intensity;
      bake();
      captured.push(await captureLightProbeGrid(renderer, baked));
    }
    const bytes = await saveLightProbeGrid(renderer, captured, {
      states: [{time: 6, name: 'dawn'}, {time: 12, name: 'noon'}, {name: 'lamp <b>off</b>'}]});
    return {file: base64(bytes), texels: captured.map(({texels}) => base64(texels)), type: captured[0].texels.constructor.name};
  },

  /** What saving says of states that a file cannot hold. */
  async refused(states) {
    return saveLightProbeGrid(renderer, baked, {states}).then(() => null, ({message}) => message);
  },

  /** Loads a file and goes through states: the texels of each, from the GPU. */
  async follow(url, states, workers = 0) {
    const events = [];
    const grid = await loader().setWorkerLimit(workers).loadAsync(url, ({loaded, total}) => events.push([loaded, total]));
    const texels = [base64(await texelsOnGpu(grid))];
    for (const state of states) {
      await grid.setState(state);
      texels.push(base64(await texelsOnGpu(grid)));
    }
    const {min, max} = grid.boundingBox;
    const result = {box: [...min.toArray(), ...max.toArray()], states: grid.states, state: grid.state, texels, events};
    grid.dispose();
    loader().setWorkerLimit(0);
    return result;
  },

  /** A grid that stays in the scene: its texels as of a state, once it was drawn. */
  async stays(url, state) {
    const grid = await loader().loadAsync(url);
    baked.removeFromParent();
    scene.add(grid);
    const target = new THREE.RenderTarget(SIZE, SIZE);
    const draw = () => { renderer.setRenderTarget(target); renderer.render(scene, camera); renderer.setRenderTarget(null); };
    draw();
    await grid.setState(state);
    draw();
    const {image} = grid.texture, {data} = image;
    image.data = null;
    const {texels} = await captureLightProbeGrid(renderer, grid);
    image.data = data;
    grid.removeFromParent();
    grid.dispose();
    target.dispose();
    scene.add(baked);
    return base64(texels);
  },

  /** The texels of a file as half, on request. */
  async asHalf(url) {
    const one = loader();
    one.half = true;
    const grid = await one.loadAsync(url);
    const result = base64(await texelsOnGpu(grid));
    grid.dispose();
    return result;
  },

  /** How many states a file has, given as each kind of source. */
  async sources(url) {
    const blob = await (await fetch(url)).blob();
    const given = [blob, new File([blob], 'x.gic'), fetch(url), blob.stream(), await blob.arrayBuffer()];
    const counts = [];
    for (const source of given) {
      const grid = await loader().parse(source);
      await grid.setState(grid.states.at(-1).time);
      counts.push(grid.states.length);
      grid.dispose();
    }
    return counts;
  },

  async failure(url) {
    try {
      await loader().loadAsync(url);
      return null;
    } catch (error) {
      return `${error.name}: ${error.message}`;
    }
  },

  /** Many states, one after the other and all at once: textures on the GPU before and after. */
  async leaks(url) {
    const before = renderer.info.memory.textures;
    for (let i = 0; i < 20; ++i) {
      const grid = await loader().loadAsync(url);
      grid.state = 8;
      grid.state = 10;
      await grid.setState(9);
      await picture(grid);
      grid.dispose();
    }
    await picture(null);
    return renderer.info.memory.textures - before;
  },
};
begin().then(() => { window.ready = true; }, (error) => { window.ready = `${error.stack}`; });
