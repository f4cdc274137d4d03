// Diffuse light of probes around a point, in GLSL for WebGLRenderer (Majercik et al. 2019, §5), as gi-render
// computes it.

/** Functions of a volume; `id` keeps those of several apart. */
export const probeFunctions = (id, {words, linear}) => /* glsl */`
uniform highp ${words ? 'usampler2DArray' : 'sampler2DArray'} gi${id}Color;
uniform highp sampler2DArray gi${id}Visibility;
uniform highp sampler2DArray gi${id}Active;
uniform vec3 gi${id}Origin, gi${id}Spacing;
uniform ivec3 gi${id}Grid, gi${id}Scroll;
uniform mat3 gi${id}ColorTile, gi${id}VisibilityTile;  // column, row and slice of a block's tile
uniform vec3 gi${id}ColorSize, gi${id}VisibilitySize;  // texels of a tile, before its core, and of its core

vec2 gi${id}Octahedral(vec3 d) {
  vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
  vec2 fold = (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
  return d.z >= 0.0 ? p : fold;
}
vec3 gi${id}Place(mat3 tile, vec3 size, ivec3 block, vec3 direction) {
  vec3 at = tile * vec3(block);
  return vec3(at.xy * size.x + size.y + (gi${id}Octahedral(direction) * 0.5 + 0.5) * size.z, at.z);
}
${words ? `
vec3 gi${id}Texel(ivec3 at) {
  uint word = texelFetch(gi${id}Color, at, 0).r;
  return vec3(uvec3(word >> ${words[0]}u, word >> ${words[1]}u, word >> ${words[2]}u) & 1023u) / 1023.0;
}
vec3 gi${id}ColorAt(vec3 place) {
  vec2 corner = floor(place.xy - 0.5), f = place.xy - 0.5 - corner;
  ivec3 at = ivec3(corner, place.z);
  return mix(mix(gi${id}Texel(at), gi${id}Texel(at + ivec3(1, 0, 0)), f.x),
             mix(gi${id}Texel(at + ivec3(0, 1, 0)), gi${id}Texel(at + ivec3(1, 1, 0)), f.x), f.y);
}` : `
vec3 gi${id}ColorAt(vec3 place) {
  return textureLod(gi${id}Color, vec3(place.xy / vec2(textureSize(gi${id}Color, 0).xy), place.z), 0.0).rgb;
}`}
vec3 gi${id}Light(vec3 worldPosition, vec3 worldNormal, vec3 worldToViewer) {
  vec3 position = (gi${id}FromWorld * vec4(worldPosition, 1.0)).xyz;
  vec3 normal = normalize(mat3(gi${id}FromWorld) * worldNormal);
  vec3 toViewer = normalize(mat3(gi${id}FromWorld) * worldToViewer);
  float least = min(gi${id}Spacing.x, min(gi${id}Spacing.y, gi${id}Spacing.z));
  vec3 biased = position + (normal * 0.2 + toViewer * 0.8) * (0.225 * least);
  vec3 at = clamp((biased - gi${id}Origin) / gi${id}Spacing, vec3(gi${id}Scroll), vec3(gi${id}Scroll + gi${id}Grid - 1));
  ivec3 base = ivec3(floor(at));
  vec3 alpha = at - vec3(base);
  vec3 light = vec3(0.0);
  float sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    ivec3 cell = min(base + ivec3(corner & 1, corner >> 1 & 1, corner >> 2), gi${id}Scroll + gi${id}Grid - 1);
    vec3 trilinear = mix(1.0 - alpha, alpha, vec3(corner & 1, corner >> 1 & 1, corner >> 2));
    ivec3 block = ivec3(mod(vec3(cell), vec3(gi${id}Grid)));  // where a volume that scrolls keeps the cell
    if (texelFetch(gi${id}Active, block, 0).r == 0.0) continue;
    vec3 probe = gi${id}Origin + vec3(cell) * gi${id}Spacing;
    float wrap = (dot(normalize(probe - position), normal) + 1.0) * 0.5;
    float weight = wrap * wrap + 0.2;
    vec3 fromProbe = biased - probe;
    float distance = max(length(fromProbe), 1e-6);
    vec3 place = gi${id}Place(gi${id}VisibilityTile, gi${id}VisibilitySize, block, fromProbe / distance);
    vec2 moments = textureLod(gi${id}Visibility, vec3(place.xy / vec2(textureSize(gi${id}Visibility, 0).xy), place.z), 0.0).xy;
    if (distance > moments.x) {
      float variance = abs(moments.x * moments.x - moments.y);
      float beyond = distance - moments.x;
      float chebyshev = variance / (variance + beyond * beyond);
      weight *= chebyshev * chebyshev * chebyshev;
    }
    weight = max(weight, 1e-6);
    if (weight < 0.2) weight *= weight * weight / 0.04;
    weight *= trilinear.x * trilinear.y * trilinear.z;
    vec3 code = gi${id}ColorAt(gi${id}Place(gi${id}ColorTile, gi${id}ColorSize, block, normal));
    light += weight * ${linear ? 'sqrt(code)' : 'pow(code, vec3(2.5))'};  // half of the gamma; the rest after mixing
    sum += weight;
  }
  return sum > 0.0 ? (light / sum) * (light / sum) : vec3(0.0);
}
`;
