// Materials of WebGLRenderer that volumes light: what is changed in their shaders, and taken back.

/** In front of a volume's own functions, of which gi<ID>Light is irradiance over pi; `id` keeps volumes apart. */
const uniformsOf = (id) => /* glsl */`
uniform mat4 gi${id}FromWorld;
uniform float gi${id}Intensity;
`;

/** What adds that light to a material's irradiance. */
const irradianceOf = (id) => /* glsl */`
#if defined(RE_IndirectDiffuse)
  irradiance += PI * gi${id}Intensity * gi${id}Light(
      ((vec4(geometryPosition, 1.0) - viewMatrix[3]) * viewMatrix).xyz, (vec4(geometryNormal, 0.0) * viewMatrix).xyz,
      (vec4(geometryViewDir, 0.0) * viewMatrix).xyz);
#endif
`;

const IN_FRONT = '#include <lights_pars_begin>', BEHIND = '#include <lights_fragment_begin>';

/** By material: what it did before, and the volumes that light it. */
const patched = new WeakMap();

/** Textures that a material may need besides those of volumes. */
export const OWN = 7;

/**
 * Lets a material be lit by a volume, too. `shader`: {key, samplers, functions(id)}, of which the key says all
 * that differs. False: with the others it would have more textures than the `most` that a program can have.
 */
export function patchMaterial(material, id, shader, uniforms, most) {
  const others = patched.get(material)?.lights.values() ?? [];
  if ([...others].reduce((sum, one) => sum + one.shader.samplers, shader.samplers) > most - OWN) return false;
  const entry = patched.get(material) ?? install(material);
  entry.lights.set(id, {shader, uniforms});
  material.needsUpdate = true;
  return true;
}

/** Takes a volume's light off a material; without any the material is as it was. */
export function restoreMaterial(material, id) {
  const entry = patched.get(material);
  if (!entry?.lights.delete(id)) return;
  material.needsUpdate = true;
  if (entry.lights.size > 0 || material.onBeforeCompile !== entry.hook) return;  // somebody else built on the hook
  Object.assign(material, entry.before);
  patched.delete(material);
}

function install(material) {
  const lights = new Map();
  const {onBeforeCompile, customProgramCacheKey} = material;
  const hook = function before(program, renderer) {
    onBeforeCompile.call(this, program, renderer);
    for (const [id, {shader, uniforms}] of lights) {
      Object.assign(program.uniforms, uniforms);
      program.fragmentShader = program.fragmentShader
          .replace(IN_FRONT, `${IN_FRONT}\n${uniformsOf(id)}${shader.functions(id)}`)
          .replace(BEHIND, `${BEHIND}\n${irradianceOf(id)}`);
    }
  };
  material.onBeforeCompile = hook;
  material.customProgramCacheKey = function key() {
    const ours = [...lights].map(([id, {shader}]) => `gi${id} ${shader.key}`);
    // The usual key is the text of the hook, which is ours now.
    return `${customProgramCacheKey.call(this)} ${onBeforeCompile} ${ours.join(' ')}`;
  };
  const entry = {lights, hook, before: {onBeforeCompile, customProgramCacheKey}};
  patched.set(material, entry);
  return entry;
}
