// What figures.mjs measures in a page.
import * as THREE from 'three';

const PARTS = 7;
let renderer, scene, camera;

function begin() {
  renderer = new THREE.WebGLRenderer();
  renderer.setSize(64, 48);
  scene = new THREE.Scene();
  scene.add(new THREE.Mesh(new THREE.BoxGeometry(12, 5, 12), new THREE.MeshStandardMaterial({side: THREE.BackSide})));
  camera = new THREE.PerspectiveCamera(60, 4 / 3, 0.1, 100);
  renderer.render(scene, camera);
}

/** A 3D texture of halves. */
function textureOf(halves, [nx, ny, nz]) {
  const texture = new THREE.Data3DTexture(halves, nx, ny, PARTS * (nz + 2));
  Object.assign(texture, {format: THREE.RGBAFormat, type: THREE.HalfFloatType, needsUpdate: true});
  return texture;
}

/** What a page loads to read a format. */
const CODE = {
  json: async () => {},
  ktx2: () => import('three/addons/loaders/KTX2Loader.js'),
  meshopt: () => Promise.all([import('three/addons/libs/meshopt_decoder.module.js'), import('three/addons/libs/zstddec.module.js')]),
  gic: async () => (await Promise.all([import('gicodec/three'), import('three/addons/lighting/LightProbeGridWebGL.js')]))[0],
};

const DECODERS = {
  /** Whole numbers of 1/4096, 27 for each probe, as an open request for three.js writes them. */
  async json(url, size) {
    const [nx, ny, nz] = size, {coefficients} = await (await fetch(url)).json();
    const halves = new Uint16Array(nx * ny * PARTS * (nz + 2) * 4);
    for (let probe = 0; probe < nx * ny * nz; ++probe) {
      const xy = probe % (nx * ny), z = Math.floor(probe / (nx * ny));
      for (let i = 0; i < 27; ++i) {
        const half = THREE.DataUtils.toHalfFloat(coefficients[27 * probe + i] / 4096);
        const at = (slice) => ((i >> 2) * (nz + 2) + slice) * nx * ny * 4 + xy * 4 + i % 4;
        halves[at(z + 1)] = half;
        if (z === 0) halves[at(0)] = half;
        if (z === nz - 1) halves[at(nz + 1)] = half;
      }
    }
    return textureOf(halves, size);
  },
  async ktx2(url) {
    const {KTX2Loader} = await CODE.ktx2();
    return new KTX2Loader().setWorkerLimit(0).detectSupport(renderer).loadAsync(url);
  },
  /** Texels as vertices of 8 bytes (EXT_meshopt_compression), and those by zstd. */
  async meshopt(url, size) {
    const [[{MeshoptDecoder}, {ZSTDDecoder}], packed] = await Promise.all([
      CODE.meshopt(), fetch(url).then((response) => response.arrayBuffer())]);
    const zstd = new ZSTDDecoder();
    await Promise.all([zstd.init(), MeshoptDecoder.ready]);
    const [nx, ny, nz] = size, count = nx * ny * PARTS * (nz + 2);
    const head = new Uint32Array(packed.slice(0, 4));
    const vertices = zstd.decode(new Uint8Array(packed, 4), head[0]);
    const out = new Uint8Array(8 * count);
    MeshoptDecoder.decodeVertexBuffer(out, count, 8, vertices);
    return textureOf(new Uint16Array(out.buffer), size);
  },
  async gic(url) {
    const {GILoader} = await CODE.gic();
    return (await new GILoader().detectSupport(renderer).loadAsync(url)).texture;
  },
};

window.page = {
  /** Loads the code of a format alone. */
  async prepare(format) {
    await CODE[format]();
  },

  /** Milliseconds until the texels are on the GPU, and a hash of them. */
  async load(format, url, size) {
    const start = performance.now();
    const texture = await DECODERS[format](url, size);
    renderer.initTexture(texture);
    renderer.getContext().finish();
    const ms = performance.now() - start;
    const {data} = texture.image;
    const digest = new Uint32Array(await crypto.subtle.digest('SHA-256', new Uint8Array(data.buffer, data.byteOffset, data.byteLength)));
    return {ms, hash: digest[0]};
  },

  /** What following a server costs, over some seconds. */
  async live(url, seconds) {
    const {GIClient} = await import('gicodec/three');
    const live = new GIClient(renderer, url);
    scene.add(live.object);
    let frames = 0;
    renderer.setAnimationLoop(() => {
      renderer.render(scene, camera);
      ++frames;
    });
    await new Promise((resolve, reject) => {
      live.addEventListener('error', ({error}) => reject(error));
      live.addEventListener('update', () => live.statistics.updates >= 5 && resolve());
    });
    const before = {...live.statistics, frames, at: performance.now()};
    await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
    const after = live.statistics, updates = after.updates - before.updates;
    const result = {updates, fps: 1000 * (frames - before.frames) / (performance.now() - before.at),
                    decodeMs: (after.decodeMs - before.decodeMs) / updates, uploadMs: (after.uploadMs - before.uploadMs) / updates};
    renderer.setAnimationLoop(null);
    live.dispose();
    return result;
  },
};
begin();
window.ready = true;
