// A page that lights a scene of gi-trace by its probes: functions that probes.test.mjs calls.
import * as THREE from 'three';
import {EXRLoader} from 'three/addons/loaders/EXRLoader.js';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {GILoader, ProbeVolumeHelper} from 'gicodec/three';

import {readWords} from './gpu_texels.js';

const webgpu = new URLSearchParams(location.search).has('webgpu');
let renderer;

async function begin() {
  const canvas = document.createElement('canvas');
  document.body.append(canvas);
  renderer = webgpu ? new THREE.WebGPURenderer({canvas}) : new THREE.WebGLRenderer({canvas});
  if (webgpu) {
    await renderer.init();
    if (!renderer.backend.isWebGPUBackend) throw new Error('WebGPU is not there');
  }
}

/** A picture as linear floats, the first row at the top. */
async function draw(scene, camera, width, height) {
  const target = new THREE.RenderTarget(width, height, {type: THREE.FloatType, colorSpace: THREE.NoColorSpace});
  const drawn = webgpu ? target : new THREE.WebGLRenderTarget(width, height, {type: THREE.FloatType});
  renderer.setRenderTarget(drawn);
  renderer.render(scene, camera);
  let pixels = new Float32Array(4 * width * height);
  if (webgpu) {
    pixels = await renderer.readRenderTargetPixelsAsync(drawn, 0, 0, width, height);
  } else {
    renderer.readRenderTargetPixels(drawn, 0, 0, width, height, pixels);
    const upside = pixels.slice();
    for (let y = 0; y < height; ++y) pixels.set(upside.subarray((height - 1 - y) * width * 4, (height - y) * width * 4), y * width * 4);
  }
  renderer.setRenderTarget(null);
  drawn.dispose();
  return pixels;
}

const base64 = (array) => {
  let text = '';
  for (const byte of new Uint8Array(array.buffer)) text += String.fromCharCode(byte);
  return btoa(text);
};

/** Pixels whose neighbours are of the same surface. */
function inside(normals, width, height) {
  const kept = [];
  for (let y = 1; y + 1 < height; ++y) {
    for (let x = 1; x + 1 < width; ++x) {
      const at = (y * width + x) * 4;
      const alike = [-4, 4, -4 * width, 4 * width].every((step) => {
        let turn = 0;
        for (let c = 0; c < 3; ++c) turn = Math.max(turn, Math.abs(normals[at + c] - normals[at + step + c]));
        return turn < 0.05;
      });
      if (alike) kept.push(at);
    }
  }
  return kept;
}

window.page = {
  async compare(file, glb, exr, {eye, target, fov, width, height, move}) {
    const scene = new THREE.Scene();
    const {scene: model} = await new GLTFLoader().loadAsync(glb);
    model.traverse(({material}) => material?.emissive?.setScalar(0));
    const lamps = [];
    model.traverse((object) => object.isLight && lamps.push(object));
    lamps.forEach((lamp) => lamp.removeFromParent());
    scene.add(model);
    const camera = new THREE.PerspectiveCamera(fov, width / height, 0.05, 500);
    camera.position.set(...eye);
    camera.lookAt(...target);
    const dark = await draw(scene, camera, width, height);
    const probes = await new GILoader().detectSupport(renderer).loadAsync(file);
    scene.add(probes);
    const lit = await draw(scene, camera, width, height);

    const texels = await Promise.all(Object.values(probes.textures).map((texture) => readWords(renderer, texture)));
    // A second volume on the same materials comes and goes, the first one in front of it, too.
    const loader = new GILoader().detectSupport(renderer);
    const others = [await loader.loadAsync(file), await loader.loadAsync(file)];
    loader.dispose();  // ends what loads, and nothing that was made
    await others[1].setState(1);
    scene.add(...others);
    const thrice = await draw(scene, camera, width, height);
    const parent = new THREE.Group();
    parent.add(others[1]);
    scene.add(parent);
    parent.visible = false;
    others[0].removeFromParent();
    others[0].dispose();
    const alone = await draw(scene, camera, width, height);
    parent.visible = true;
    others[1].removeFromParent();
    others[1].dispose();
    const left = await draw(scene, camera, width, height);

    const helper = new ProbeVolumeHelper(probes);
    probes.add(helper);
    const helped = await draw(scene, camera, width, height);
    const {shown} = helper;
    helper.colors = 'age';
    helper.update(performance.now() + 1e6);
    const aged = await draw(scene, camera, width, height);
    helper.dispose();
    const unhelped = await draw(scene, camera, width, height);
    probes.visible = false;
    const hidden = await draw(scene, camera, width, height);
    probes.removeFromParent();
    const states = probes.states;
    probes.dispose();
    const after = await draw(scene, camera, width, height);

    scene.overrideMaterial = new THREE.MeshNormalMaterial();
    const normals = await draw(scene, camera, width, height);
    scene.overrideMaterial = null;
    const {image: {data: reference}} = await new EXRLoader().setDataType(THREE.FloatType).loadAsync(exr);
    const upright = new Float32Array(reference.length);  // EXRLoader's first row is at the bottom
    for (let y = 0; y < height; ++y) upright.set(reference.subarray((height - 1 - y) * width * 4, (height - y) * width * 4), y * width * 4);
    const kept = inside(normals, width, height);
    let error = 0, peak = 0, mean = 0, meanWanted = 0;
    for (const at of kept) {
      for (let c = 0; c < 3; ++c) {
        const [is, wanted] = [lit[at + c], upright[at + c]].map((value) => Math.min(1, Math.max(0, value)) ** (1 / 2.2));
        error += (is - wanted) ** 2;
        peak = Math.max(peak, wanted);
        mean += is / (3 * kept.length);
        meanWanted += wanted / (3 * kept.length);
      }
    }
    const differing = (a, b) => a.reduce((count, value, i) => count + (value !== b[i]), 0);
    const sum = (pixels) => pixels.reduce((all, value, i) => all + (i % 4 === 3 ? 0 : value), 0);
    return {psnr: -10 * Math.log10(error / (3 * kept.length)), kept: kept.length, pixels: width * height, peak, mean, meanWanted,
            thrice: sum(thrice), alone: differing(lit, alone), left: differing(lit, left), shown, helperDiffers: differing(lit, helped), ageDiffers: differing(helped, aged), unhelped: differing(lit, unhelped),
            first: probes.probePosition(0).toArray(), dark: sum(dark), lit: sum(lit), hidden: sum(hidden), after: sum(after), states,
            texels: texels.map(base64)};
  },
};
begin().then(() => { window.ready = true; }, (error) => { window.ready = `${error.stack}`; });
