// What a volume of probes is made of: its bounds, and a sphere for each active probe.
import {
  Box3Helper, Color, DataUtils, DynamicDrawUsage, Group, InstancedMesh, Matrix4, MeshBasicMaterial, SphereGeometry, Vector3,
} from 'three';

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
  #spheres;
  #box;

  constructor(volume, {radius, colors = 'light', fade = 2000} = {}) {
    super();
    if (!['light', 'age'].includes(colors)) throw new RangeError(`colors is "light" or "age", not ${colors}`);
    this.#volume = volume;
    this.colors = colors;
    this.fade = fade;
    const [nx, ny, nz] = volume.grid, count = nx * ny * nz;
    const first = volume.probePosition(0);
    // To the neighbours along each axis that has any.
    const least = Math.min(...[[nx, 1], [ny, nx], [nz, nx * ny]].filter(([side]) => side > 1)
        .map(([, step]) => volume.probePosition(step).distanceTo(first)), 1);
    this.#spheres = new InstancedMesh(new SphereGeometry(radius ?? least / 8, 12, 8), new MeshBasicMaterial(), count);
    this.#spheres.instanceMatrix.setUsage(DynamicDrawUsage);
    this.#spheres.frustumCulled = false;
    this.#box = new Box3Helper(volume.boundingBox);
    this.add(this.#spheres, this.#box);
    this.update();
  }

  update(now = performance.now()) {
    const volume = this.#volume, spheres = this.#spheres;
    const matrix = new Matrix4(), at = new Vector3(), color = new Color(), hidden = new Matrix4().makeScale(0, 0, 0);
    let shown = 0;
    for (let probe = 0; probe < spheres.count; ++probe) {
      const active = volume.isActive(probe);
      shown += active;
      spheres.setMatrixAt(probe, active ? matrix.makeTranslation(volume.probePosition(probe, at)) : hidden);
      if (!active) continue;
      if (this.colors === 'light') this.#light(probe, color);
      else color.lerpColors(FRESH, OLD, Math.min(1, Math.max(0, (now - volume.changedAt[probe]) / this.fade)));
      spheres.setColorAt(probe, color);
    }
    spheres.instanceMatrix.needsUpdate = true;
    if (spheres.instanceColor) spheres.instanceColor.needsUpdate = true;
    /** How many probes are active. */
    this.shown = shown;
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
    this.#spheres.geometry.dispose();
    this.#spheres.material.dispose();
    this.#spheres.dispose();
    this.#box.dispose();
  }
}
