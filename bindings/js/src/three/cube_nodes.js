// The same as cube_shader.js for WebGPURenderer, as nodes.
import {AnalyticLightNode} from 'three/webgpu';
import {Fn, If, PI, normalWorld, positionWorld, renderGroup, texture3D, uniform, vec3} from 'three/tsl';

import {haveRoom} from './node_textures.js';

/** The node of an AmbientCubeVolume. */
export class AmbientCubeVolumeNode extends AnalyticLightNode {
  static get type() {
    return 'AmbientCubeVolumeNode';
  }

  setup(builder) {
    if (!haveRoom(builder, this.light, 1)) return;
    const {uniforms} = this.light;
    // Shared, so that they are looked at though an object stands still.
    const [fromWorld, least, size] = ['FromWorld', 'Least', 'Size'].map((name) => uniform(uniforms[name].value).setGroup(renderGroup));
    const intensity = uniform(1).setGroup(renderGroup).onRenderUpdate(() => uniforms.Intensity.value);
    const {width, height, depth} = uniforms.Cubes.value.image;
    const texels = vec3(width, height, depth), cells = vec3(width, height / 2, depth / 3);
    const light = Fn(() => {
      const at = fromWorld.mul(positionWorld.toVec4(1)).xyz.sub(least).div(size).toVar();
      const sum = vec3(0).toVar();
      const inside = at.x.greaterThanEqual(0).and(at.y.greaterThanEqual(0)).and(at.z.greaterThanEqual(0))
          .and(at.x.lessThanEqual(1)).and(at.y.lessThanEqual(1)).and(at.z.lessThanEqual(1));
      If(inside, () => {
        const normal = fromWorld.mul(normalWorld.toVec4(0)).xyz.normalize().toVar();
        const place = at.mul(cells).clamp(vec3(0.5), cells.sub(0.5)).div(texels).toVar();
        ['x', 'y', 'z'].forEach((axis, i) => {
          const away = normal[axis].lessThan(0).select(0.5, 0);  // faces towards the negative end
          const texel = texture3D(uniforms.Cubes.value, place.add(vec3(0, away, i / 3))).level(0);
          sum.addAssign(texel.rgb.mul(normal[axis].mul(normal[axis])));
        });
      });
      return sum.mul(intensity).mul(PI);
    });
    builder.context.irradiance.addAssign(light());
  }
}
