// The scene, its cameras, and how it is drawn.
import {
  Box3, DirectionalLight, Mesh, NeutralToneMapping, OrthographicCamera, PerspectiveCamera, PlaneGeometry, Scene, ShaderMaterial,
  TextureLoader, Vector3, WebGLRenderTarget, WebGLRenderer, HalfFloatType,
} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {ProbeVolumeHelper} from 'gicodec/three';

import {LitSpheres} from './lit_spheres.js';
import {WalkControls} from './walk.js';

export class Stage {
  mode = 'both';
  lit = false;  // there is a scene to light
  onframe = () => {};
  #renderer;
  #scene = new Scene();
  #camera = new PerspectiveCamera(60, 1, 0.05, 2000);
  #orbit;
  #walk;
  #model = null;
  #lamps = [];
  #lights = [];    // what the file or the server shows
  #others = [];    // what it is compared with
  #helpers = [];
  #probes = 'none';
  #difference = null;
  #last = performance.now();

  constructor(canvas) {
    this.#renderer = new WebGLRenderer({canvas, antialias: true});
    this.#renderer.toneMapping = NeutralToneMapping;
    this.#camera.position.set(4, 3, 8);
    this.#orbit = new OrbitControls(this.#camera, canvas);
    this.#walk = new WalkControls(this.#camera, canvas);
    this.#renderer.setAnimationLoop(() => this.#draw());
  }

  get renderer() { return this.#renderer; }
  get camera() { return this.#camera; }
  set exposure(stops) { this.#renderer.toneMappingExposure = 2 ** stops; }

  set walking(on) {
    this.#walk.enabled = on;
    this.#orbit.enabled = !on;
    if (!on) this.#orbit.target.copy(this.#camera.position).addScaledVector(this.#camera.getWorldDirection(new Vector3()), 3);
  }

  /** Takes a glTF scene, of bytes or a URL. */
  async setModel(source, onProgress) {
    const loader = new GLTFLoader();
    // Elements of images, which need no permission to connect.
    loader.register((parser) => ({name: 'images', beforeRoot: async () => {
      parser.textureLoader = new TextureLoader(parser.options.manager);
    }}));
    const {scene, cameras: [camera]} = typeof source === 'string'
      ? await loader.loadAsync(source, onProgress) : await loader.parseAsync(source, '');
    this.#model?.removeFromParent();
    free(this.#model);
    this.#model = scene;
    this.#lamps = [];
    scene.traverse((object) => object.isLight && this.#lamps.push(object));
    if (this.#lamps.length === 0) {
      this.#lamps = [new DirectionalLight(0xffffff, 2)];
      this.#lamps[0].position.set(1, 2, 1.5);
      scene.add(this.#lamps[0]);
    }
    this.#scene.add(scene);
    this.lit = true;
    if (camera) {
      camera.updateWorldMatrix(true, false);
      camera.matrixWorld.decompose(this.#camera.position, this.#camera.quaternion, new Vector3());
      this.#orbit.target.copy(this.#camera.position).addScaledVector(this.#camera.getWorldDirection(new Vector3()), 3);
    } else {
      this.frame();
    }
  }

  /** Shows objects of GILoader, or of a GIClient; `beside`: to be compared with those. */
  setLights(objects, beside = false) {
    const list = beside ? this.#others : this.#lights;
    for (const old of list) {
      old.removeFromParent();
      old.dispose?.();
    }
    list.splice(0, list.length, ...objects);
    for (const object of objects) this.#scene.add(object);
    if (!this.#model && !beside) this.frame();
    this.probes = this.#probes;
  }

  /** Looks at everything. */
  frame() {
    const box = new Box3();
    if (this.#model) box.setFromObject(this.#model);
    for (const light of this.#volumes()) if (light.boundingBox) box.union(light.boundingBox);
    if (box.isEmpty()) return;
    const [center, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3()).length()];
    this.#camera.position.copy(center).add(new Vector3(0.35, 0.25, 0.6).multiplyScalar(size / Math.min(1, this.#camera.aspect)));
    this.#camera.far = 10 * size;
    this.#camera.updateProjectionMatrix();
    this.#orbit.target.copy(center);
    this.#walk.speed = size / 10;
  }

  #volumes() {
    const found = [];
    for (const light of this.#lights) light.traverse((one) => one.boundingBox && one.isLight && found.push(one));
    return found;
  }

  /** "none", "light" or "age". */
  set probes(kind) {
    this.#probes = kind;
    this.#helpers.forEach(({helper}) => helper.dispose());
    this.#helpers = [];
    if (kind === 'none') return;
    for (const volume of this.#volumes()) {
      const helper = volume.isProbeVolume ? new ProbeVolumeHelper(volume, {colors: kind}) : new LitSpheres(volume);
      (volume.isProbeVolume ? volume : this.#scene).add(helper);
      this.#helpers.push({volume, helper});
    }
  }

  /** What changed is shown. */
  refresh() {
    if (this.#probes === 'none') return;
    const volumes = this.#volumes();
    const same = volumes.length === this.#helpers.length && volumes.every((volume, i) => this.#helpers[i].volume === volume);
    if (!same) this.probes = this.#probes;  // the server has other volumes
    else this.#helpers.forEach(({helper}) => helper.update?.());
  }

  #draw() {
    const now = performance.now(), seconds = Math.min(0.1, (now - this.#last) * 1e-3);
    this.#last = now;
    const {clientWidth, clientHeight} = this.#renderer.domElement;
    const {width, height} = this.#renderer.domElement, ratio = Math.min(2, devicePixelRatio);
    if (width !== Math.floor(clientWidth * ratio) || height !== Math.floor(clientHeight * ratio)) {
      this.#renderer.setPixelRatio(ratio);
      this.#renderer.setSize(clientWidth, clientHeight, false);
      this.#camera.aspect = clientWidth / Math.max(1, clientHeight);
      this.#camera.updateProjectionMatrix();
    }
    if (this.#orbit.enabled) this.#orbit.update();
    this.#walk.update(seconds);
    this.onframe();
    if (this.#probes === 'age') this.#helpers.forEach(({helper}) => helper.update?.());
    const comparing = this.mode === 'difference' && this.#others.length > 0;
    this.#show(this.mode !== 'direct', false);
    if (!comparing) return this.#renderer.render(this.#scene, this.#camera);
    this.#difference ??= new Difference();
    this.#difference.draw(this.#renderer, this.#scene, this.#camera, (second) => this.#show(!second, second));
  }

  #show(lights, others) {
    const direct = this.mode === 'both' || this.mode === 'direct';
    this.#lamps.forEach((lamp) => { lamp.visible = direct; });
    this.#lights.forEach((light) => { light.visible = lights; });
    this.#others.forEach((light) => { light.visible = others; });
  }
}

function free(object) {
  object?.traverse(({geometry, material}) => {
    geometry?.dispose();
    for (const one of [material].flat()) {
      if (!one) continue;
      Object.values(one).forEach((value) => value?.isTexture && value.dispose());
      one.dispose();
    }
  });
}

/** How far two pictures are apart, eight times as bright. */
class Difference {
  #targets = [0, 1].map(() => new WebGLRenderTarget(1, 1, {type: HalfFloatType}));
  #scene = new Scene();
  #camera = new OrthographicCamera(-1, 1, 1, -1, 0, 1);
  #material = new ShaderMaterial({
    uniforms: {a: {value: this.#targets[0].texture}, b: {value: this.#targets[1].texture}}, depthTest: false,
    vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: 'uniform sampler2D a, b; varying vec2 at;' +
      'void main() { gl_FragColor = vec4(8.0 * abs(texture2D(a, at).rgb - texture2D(b, at).rgb), 1.0); }',
  });

  constructor() {
    this.#scene.add(new Mesh(new PlaneGeometry(2, 2), this.#material));
  }

  draw(renderer, scene, camera, choose) {
    const {width, height} = renderer.domElement;
    this.#targets.forEach((target, i) => {
      target.setSize(width, height);
      choose(i === 1);
      renderer.setRenderTarget(target);
      renderer.render(scene, camera);
    });
    renderer.setRenderTarget(null);
    renderer.render(this.#scene, this.#camera);
  }
}
