// The same for WebGPURenderer, as nodes.
import {AnalyticLightNode} from 'three/webgpu';
import {
  Fn, If, Loop, PI, float, floor, int, ivec2, ivec3, max, min, mix, mod, normalWorld, positionViewDirection, positionWorld,
  renderGroup, texture, transformDirection, uint, uniform, vec2, vec3, cameraWorldMatrix,
} from 'three/tsl';

import {haveRoom} from './node_textures.js';

/** The node of a ProbeVolume. */
export class ProbeVolumeNode extends AnalyticLightNode {
  static get type() {
    return 'ProbeVolumeNode';
  }

  setup(builder) {
    if (!haveRoom(builder, this.light, 3)) return;
    const {uniforms, kind} = this.light;
    // Shared, so that they are looked at though an object stands still.
    const value = (name) => uniform(uniforms[name].value).setGroup(renderGroup);
    const size = (name) => value(`${name}Size`);
    const [fromWorld, origin, spacing] = ['FromWorld', 'Origin', 'Spacing'].map((name) => value(name));
    const [grid, scroll] = ['Grid', 'Scroll'].map((name) => ivec3(value(name)));
    const intensity = uniform(1).setGroup(renderGroup).onRenderUpdate(() => uniforms.Intensity.value);
    const octahedral = Fn(([d]) => {
      const p = d.xy.div(d.x.abs().add(d.y.abs()).add(d.z.abs())).toVar();
      const fold = p.yx.abs().oneMinus().mul(vec2(p.x.greaterThanEqual(0).select(1, -1), p.y.greaterThanEqual(0).select(1, -1)));
      return d.z.greaterThanEqual(0).select(p, fold);
    });
    const place = (name, block, direction) => {
      const at = value(`${name}Tile`).mul(vec3(block));
      const s = size(name);
      return vec3(at.xy.mul(s.x).add(s.y).add(octahedral(direction).mul(0.5).add(0.5).mul(s.z)), at.z).toVar();
    };
    const sample = (name, at) => {
      const {width, height} = uniforms[name].value.image;
      return texture(uniforms[name].value, at.xy.div(vec2(width, height))).depth(int(at.z)).level(0);
    };
    const load = (name, at, depth) => texture(uniforms[name].value).load(at).depth(depth);
    const texel = (at, depth) => {
      const word = uint(load('Color', at, depth).x).toVar();
      return vec3(...kind.words.map((bit) => float(word.shiftRight(uint(bit)).bitAnd(uint(1023))))).div(1023);
    };
    const colorAt = (at) => {
      if (!kind.words) return sample('Color', at).rgb;
      const corner = floor(at.xy.sub(0.5)).toVar();
      const f = at.xy.sub(0.5).sub(corner).toVar();
      const i = ivec2(corner).toVar(), depth = int(at.z).toVar();
      return mix(mix(texel(i, depth), texel(i.add(ivec2(1, 0)), depth), f.x),
                 mix(texel(i.add(ivec2(0, 1)), depth), texel(i.add(ivec2(1, 1)), depth), f.x), f.y);
    };

    const light = Fn(() => {
      const turned = (direction) => fromWorld.mul(direction.toVec4(0)).xyz.normalize().toVar();
      const position = fromWorld.mul(positionWorld.toVec4(1)).xyz.toVar();
      const normal = turned(normalWorld);
      const toViewer = turned(transformDirection(positionViewDirection, cameraWorldMatrix));
      const least = min(spacing.x, min(spacing.y, spacing.z));
      const biased = position.add(normal.mul(0.2).add(toViewer.mul(0.8)).mul(least.mul(0.225))).toVar();
      const last = scroll.add(grid).sub(1);
      const at = biased.sub(origin).div(spacing).clamp(vec3(scroll), vec3(last)).toVar();
      const base = ivec3(floor(at)).toVar();
      const alpha = at.sub(floor(at)).toVar();
      const sum = vec3(0).toVar(), weights = float(0).toVar();
      Loop(8, ({i}) => {
        const step = ivec3(i.bitAnd(1), i.shiftRight(1).bitAnd(1), i.shiftRight(2)).toVar();
        const cell = min(base.add(step), last).toVar();
        const trilinear = mix(alpha.oneMinus(), alpha, vec3(step)).toVar();
        const block = ivec3(mod(vec3(cell), vec3(grid))).toVar();
        If(load('Active', block.xy, block.z).x.greaterThan(0), () => {
          const probe = origin.add(vec3(cell).mul(spacing)).toVar();
          const wrap = probe.sub(position).normalize().dot(normal).add(1).mul(0.5).toVar();
          const weight = wrap.mul(wrap).add(0.2).toVar();
          const fromProbe = biased.sub(probe).toVar();
          const distance = max(fromProbe.length(), 1e-6).toVar();
          const moments = sample('Visibility', place('Visibility', block, fromProbe.div(distance))).xy.toVar();
          If(distance.greaterThan(moments.x), () => {
            const variance = moments.x.mul(moments.x).sub(moments.y).abs().toVar();
            const beyond = distance.sub(moments.x).toVar();
            const chebyshev = variance.div(variance.add(beyond.mul(beyond))).toVar();
            weight.mulAssign(chebyshev.mul(chebyshev).mul(chebyshev));
          });
          weight.assign(max(weight, 1e-6));
          If(weight.lessThan(0.2), () => {
            weight.mulAssign(weight.mul(weight).div(0.04));
          });
          weight.mulAssign(trilinear.x.mul(trilinear.y).mul(trilinear.z));
          const code = colorAt(place('Color', block, normal)).toVar();
          sum.addAssign((kind.linear ? code.sqrt() : code.pow(vec3(2.5))).mul(weight));
          weights.addAssign(weight);
        });
      });
      const mean = sum.div(max(weights, 1e-30)).toVar();
      return mean.mul(mean).mul(intensity).mul(PI);
    });
    builder.context.irradiance.addAssign(light());
  }
}
