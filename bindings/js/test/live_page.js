// A page that follows a server: functions that live.test.mjs calls.
import * as THREE from 'three';
import {GIClient} from 'gicodec/three';

import {readTexels, readWords} from './gpu_texels.js';

const parameters = new URLSearchParams(location.search);
const webgpu = parameters.has('webgpu');
let renderer, scene, camera, live = null, seen = [], events = [];

async function begin() {
  renderer = webgpu ? new THREE.WebGPURenderer() : new THREE.WebGLRenderer();
  if (webgpu) await renderer.init();
  renderer.setSize(64, 64);
  // SwiftShader's WebGPU ends where a headless page draws on a canvas.
  if (webgpu) renderer.setRenderTarget(new THREE.RenderTarget(64, 64));
  scene = new THREE.Scene();
  scene.add(new THREE.Mesh(new THREE.BoxGeometry(4, 4, 4), webgpu ? new THREE.MeshStandardNodeMaterial() : new THREE.MeshStandardMaterial()));
  camera = new THREE.PerspectiveCamera(60, 1, 0.1, 100);
  camera.position.set(0, 2, 8);
}

const hex = (buffer) => Array.from(new Uint8Array(buffer, 0, 8), (byte) => byte.toString(16).padStart(2, '0')).join('');
const digest = async (array) => hex(await crypto.subtle.digest('SHA-256', array));

/** Whether the GPU has these texels: halves of four components, or bytes of one or four. */
async function isOnGpu(texture, held) {
  const {bytes, values} = await readTexels(renderer, texture);
  const wanted = new Uint8Array(held.buffer);
  if (bytes) return wanted.every((one, i) => one === bytes[i]);
  const floats = new Float32Array(values.buffer).filter((_, i) => texture.format !== THREE.RedFormat || i % 4 === 0);
  if (texture.type === THREE.HalfFloatType) return new Uint16Array(wanted.buffer).every((one, i) => one === THREE.DataUtils.toHalfFloat(floats[i]));
  return wanted.every((one, i) => one === Math.round(255 * floats[i]));
}

/** A connection to NATS of these options, where `source` is no URL. */
async function sourceOf(source) {
  if (typeof source === 'string') return source;
  const {wsconnect} = await import('/nats-core.js');
  return wsconnect({reconnectTimeWait: 100, ...source});
}

window.page = {
  /** Follows a server of a layout: what of each update is on the GPU. */
  follow(url, layout, names) {
    seen = [];
    live = new GIClient(renderer, url, {metadata: () => ({'gicodec:layout': layout, 'gicodec:bounds': '0 0 0 1 1 1'})});
    scene.add(live.object);
    live.addEventListener('error', ({error}) => seen.push({error: error.message}));
    let busy = false;
    live.addEventListener('update', async ({uploadedBytes, state}) => {
      renderer.render(scene, camera);
      const [shown] = live.object.children, held = live.texels();
      const textures = shown.isTextureVolume ? Object.fromEntries(shown.textures) : {[names[0]]: shown.texture};
      if (uploadedBytes === 0 && busy) return;
      busy = true;
      const same = names.map((name) => isOnGpu(textures[name], held[name].slice()));
      const digests = names.map((name) => digest(held[name].slice()));
      seen.push({type: shown.type, uploadedBytes, time: state.time, same: await Promise.all(same), held: await Promise.all(digests)});
      busy = false;
    });
  },
  async start(source, options) {
    seen = [];
    events = [];
    live = new GIClient(renderer, await sourceOf(source), options);
    scene.add(live.object);
    let turn = Promise.resolve();
    for (const type of ['connected', 'volumes', 'lost', 'closed', 'error']) {
      live.addEventListener(type, ({wait, why, reason, error}) => events.push({type, wait, why, reason, error: error?.message}));
    }
    live.addEventListener('update', ({state, blocks, uploadedBytes}) => {
      live.setView(camera);
      renderer.render(scene, camera);
      const {color, vis} = live.texels();
      const [held, shown] = [[color, vis].map((one) => one.slice()), readWords(renderer, live.object.children[0].textures.color)];
      turn = turn.then(async () => seen.push({
        time: state.time, blocks, uploadedBytes, color: await digest(held[0]), vis: await digest(held[1]), gpu: await digest(await shown)}));
    });
  },
  /** Follows a server, and draws what it has. */
  draw(url) {
    live = new GIClient(renderer, url);
    scene.add(live.object);
    renderer.setAnimationLoop(() => renderer.render(scene, camera));
  },
  render: () => renderer.render(scene, camera),
  seen: () => seen,
  events: () => events,
  statistics: () => live.statistics,
  stop: () => live.dispose(),
  async lose() {
    const extension = renderer.getContext().getExtension('WEBGL_lose_context');
    extension.loseContext();
    await new Promise((resolve) => setTimeout(resolve, 100));
    extension.restoreContext();
    await new Promise((resolve) => setTimeout(resolve, 100));
  },
  textures: () => renderer.info.memory.textures,
};
begin().then(() => { window.ready = true; }, (error) => { window.ready = `${error.stack}`; });
