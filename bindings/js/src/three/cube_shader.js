// Diffuse light of ambient cubes around a point, in GLSL for WebGLRenderer (Mitchell 2006), as Bevy lays them out.

/** What differs in volumes of ambient cubes: nothing. */
export const cubeShader = {
  key: 'cubes', samplers: 1,
  functions: (id) => /* glsl */`
uniform highp sampler3D gi${id}Cubes;
uniform vec3 gi${id}Least, gi${id}Size;  // of the box that is lit
vec3 gi${id}Light(vec3 worldPosition, vec3 worldNormal, vec3 worldToViewer) {
  vec3 at = ((gi${id}FromWorld * vec4(worldPosition, 1.0)).xyz - gi${id}Least) / gi${id}Size;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return vec3(0.0);
  vec3 normal = normalize(mat3(gi${id}FromWorld) * worldNormal);
  vec3 texels = vec3(textureSize(gi${id}Cubes, 0)), cells = texels / vec3(1.0, 2.0, 3.0);
  vec3 place = clamp(at * cells, vec3(0.5), cells - 0.5) / texels;
  vec3 away = mix(vec3(0.0), vec3(0.5), lessThan(normal, vec3(0.0)));  // faces towards the negative end of an axis
  vec3 share = normal * normal;
  return share.x * textureLod(gi${id}Cubes, place + vec3(0.0, away.x, 0.0), 0.0).rgb +
         share.y * textureLod(gi${id}Cubes, place + vec3(0.0, away.y, 1.0 / 3.0), 0.0).rgb +
         share.z * textureLod(gi${id}Cubes, place + vec3(0.0, away.z, 2.0 / 3.0), 0.0).rgb;
}
`,
};
