// How many textures of volumes a material of WebGPURenderer has.
import {OWN} from './material_patch.js';

const used = new WeakMap();  // by what builds a material

/** Whether a volume's textures have room beside those of others; it says so where they have none. */
export function haveRoom(builder, light, count) {
  const most = builder.renderer.backend.device?.limits.maxSampledTexturesPerShaderStage ?? 16;
  const sum = (used.get(builder) ?? 0) + count;
  if (sum > most - OWN) {
    light.refuse(most);
    return false;
  }
  used.set(builder, sum);
  return true;
}
