// What a volume of probes is made of: its bounds, and a sphere for each active probe.
import {
  Box3Helper, Color, DataUtils, DynamicDrawUsage, Group, InstancedMesh, Matrix4, MeshBasicMaterial, OctahedronGeometry,
  SphereGeometry, Vector3,
} from 'three';

/** Probes from which on they are octahedra. */
const MANY = 2048;
const FRESH = new Color(0xff5020), OLD = new Color(0x203860);

/** Decoders of texels to radiance's code: component i of the texel at a byte. */
const CODES = {
  A2R10G10B10_UNORM_PACK32: (data, at, i) => (data.getUint32(at, true) >>> (20 - 10 * i) & 1023) / 1023,
  A2B10G10R10_UNORM_PACK32: (data, at, i) => (data.getUint32(at, true) >>> (10 * i) & 1023) / 1023,
  R8G8B8A8_UNORM: (data, at, i) => data.getUint8(at + i) / 255,
  R16G16B16A16_SFLOAT: (data, at, i) => DataUtils.fromHalfFloat(data.getUint16(at + 2 * i, true)),
  R32G32B32A32_SFLOAT: (data, at, i) => data.getFloat32(at + 4 * i, true),
  B10G11R11_UFLOAT_PACK32: (data, at, i) => {
    const code = data.getUint32(at, true) >>> (11 * i) & (i === 2 ? 1023 : 2047);
    return DataUtils.fromHalfFloat(code << (i === 2 ? 5 : 4));
  },
  E5B9G9R9_UFLOAT_PACK32: (data, at, i) => {
    const word = data.getUint32(at, true);
    return (word >>> (9 * i) & 511) * 2 ** ((word >>> 27) - 24);
  },
};

/**
 * Shows a ProbeVolume, whose child it is to be: `volume.add(new ProbeVolumeHelper(volume))`. Spheres have the
 * mean light of their probes, or with `colors: 'age'` fade in `fade` milliseconds after their last change.
 * update() shows what is new.
 */
export class ProbeVolumeHelper extends Group {
  type = 'ProbeVolumeHelper';
  #volume;
  #spheres = null;
  #radius;
  #probes;
  #box;

  constructor(volume, {radius, colors = 'light', fade = 2000} = {}) {
    super();
    if (!volume?.isProbeVolume) throw new TypeError(`ProbeVolumeHelper shows a ProbeVolume, not ${volume?.type ?? volume}`);
    if (!['light', 'age'].includes(colors)) throw new RangeError(`colors is "light" or "age", not ${colors}`);
    this.#volume = volume;
    this.colors = colors;
    this.fade = fade;
    const [nx, ny, nz] = volume.grid;
    const first = volume.probePosition(0);
    // To the neighbours along each axis that has any.
    const least = Math.min(...[[nx, 1], [ny, nx], [nz, nx * ny]].filter(([side]) => side > 1)
        .map(([, step]) => volume.probePosition(step).distanceTo(first)), 1);
    this.#radius = radius ?? least / 8;
    this.#probes = nx * ny * nz;
    this.#box = new Box3Helper(volume.boundingBox);
    this.add(this.#box);
    this.update();
  }

  update(now = performance.now()) {
    const volume = this.#volume, active = [];
    for (let probe = 0; probe < this.#probes; ++probe) if (volume.isActive(probe)) active.push(probe);
    const spheres = this.#spheresFor(active.length);
    const matrix = new Matrix4(), at = new Vector3(), color = new Color();
    spheres.count = active.length;
    active.forEach((probe, place) => {
      spheres.setMatrixAt(place, matrix.makeTranslation(volume.probePosition(probe, at)));
      if (this.colors === 'light') this.#light(probe, color);
      else color.lerpColors(FRESH, OLD, Math.min(1, Math.max(0, (now - volume.changedAt[probe]) / this.fade)));
      spheres.setColorAt(place, color);
    });
    spheres.instanceMatrix.needsUpdate = true;
    if (spheres.instanceColor) spheres.instanceColor.needsUpdate = true;
    /** How many probes are active. */
    this.shown = active.length;
  }

  /** Room for that many spheres; the more there are, the simpler they are. */
  #spheresFor(count) {
    if (this.#spheres && count <= this.#spheres.instanceMatrix.count) return this.#spheres;
    this.#freeSpheres();
    const room = Math.max(64, 2 ** Math.ceil(Math.log2(Math.max(1, count))));
    const geometry = room > MANY ? new OctahedronGeometry(this.#radius) : new SphereGeometry(this.#radius, 12, 8);
    this.#spheres = new InstancedMesh(geometry, new MeshBasicMaterial(), room);
    this.#spheres.instanceMatrix.setUsage(DynamicDrawUsage);
    this.#spheres.frustumCulled = false;
    this.add(this.#spheres);
    return this.#spheres;
  }

  #freeSpheres() {
    this.#spheres?.removeFromParent();
    this.#spheres?.geometry.dispose();
    this.#spheres?.material.dispose();
    this.#spheres?.dispose();
  }

  #light(probe, color) {
    const {desc, tiles} = this.#volume.irradiance, {data} = this.#volume.textures.color.image;
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const bytes = desc.textureBytes / (desc.width * desc.height * desc.slices);
    const code = CODES[desc.format], sum = [0, 0, 0];
    let texels = 0;
    tiles.forRows(probe, (first, end) => {
      for (let texel = first; texel < end; texel += bytes, ++texels) {
        for (let i = 0; i < 3; ++i) sum[i] += this.#volume.kind.linear ? code(view, texel, i) : code(view, texel, i) ** 5;
      }
    });
    color.setRGB(...sum.map((one) => one / texels));
  }

  dispose() {
    this.removeFromParent();
    this.#freeSpheres();
    this.#box.dispose();
  }
}
