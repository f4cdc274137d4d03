// Indirect light from probes (Majercik et al. 2019) as they arrive: an atlas_xy_z of blocks with a
// guard band of one texel, which lets hardware filter within a block without its neighbours.
// Colour is irradiance over pi, gamma-5 encoded in formats of unorm; visibility is mean distance
// and mean squared distance.

struct ProbeVolume {
  ivec3 grid;      // probes along each axis
  vec3 origin;     // VolumeGeometry: of cell 0
  vec3 spacing;
  ivec3 scroll;    // of this frame
  float color_core, visibility_core;  // texels of a block's side, without guard band
};

layout(binding = 0) uniform sampler2D color_atlas;       // linear filter, no mipmaps
layout(binding = 1) uniform sampler2D visibility_atlas;
layout(std430, binding = 2) readonly buffer Received {
  uint received[];  // per block: ClientTexture::changed is not 0
};

// A unit direction in the square [-1, 1]^2.
vec2 octahedral(vec3 d) {
  vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
  vec2 fold = (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
  return d.z >= 0.0 ? p : fold;
}

// The block of a cell: a volume that scrolls keeps each cell's block where it is.
ivec3 block_of(ProbeVolume v, ivec3 cell) {
  return ivec3(mod(vec3(cell), vec3(v.grid)));
}

// Where a direction is in a block's tile of the atlas.
vec2 tile_uv(ProbeVolume v, ivec3 block, vec3 direction, float core, vec2 size) {
  vec2 tile = vec2(block.x + v.grid.x * block.y, block.z) * (core + 2.0);
  return (tile + 1.0 + (octahedral(direction) * 0.5 + 0.5) * core) / size;
}

// Irradiance over pi at a position with a normal, seen from `to_viewer`.
vec3 probe_light(ProbeVolume v, vec3 position, vec3 normal, vec3 to_viewer) {
  float least = min(v.spacing.x, min(v.spacing.y, v.spacing.z));
  vec3 biased = position + (normal * 0.2 + to_viewer * 0.8) * (0.225 * least);
  vec3 at = clamp((biased - v.origin) / v.spacing, vec3(v.scroll), vec3(v.scroll + v.grid - 1));
  ivec3 base = ivec3(floor(at));
  vec3 alpha = at - vec3(base);
  vec2 color_size = vec2(textureSize(color_atlas, 0));
  vec2 visibility_size = vec2(textureSize(visibility_atlas, 0));
  vec3 light = vec3(0.0);
  float sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    ivec3 step = ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
    ivec3 cell = min(base + step, v.scroll + v.grid - 1);
    ivec3 block = block_of(v, cell);
    // One that never came for the place where it stands is not black: it is left out.
    if (received[block.x + v.grid.x * (block.y + v.grid.y * block.z)] == 0u) continue;
    vec3 trilinear = mix(1.0 - alpha, alpha, vec3(step));
    vec3 probe = v.origin + vec3(cell) * v.spacing;
    float wrap = (dot(normalize(probe - position), normal) + 1.0) * 0.5;
    float weight = wrap * wrap + 0.2;
    vec3 from_probe = biased - probe;
    float distance = max(length(from_probe), 1e-6);
    vec2 uv = tile_uv(v, block, from_probe / distance, v.visibility_core, visibility_size);
    vec2 moments = textureLod(visibility_atlas, uv, 0.0).xy;
    if (distance > moments.x) {
      float variance = abs(moments.x * moments.x - moments.y);
      float beyond = distance - moments.x;
      float chebyshev = variance / (variance + beyond * beyond);
      weight *= chebyshev * chebyshev * chebyshev;
    }
    weight = max(weight, 1e-6);
    if (weight < 0.2) weight *= weight * weight / 0.04;
    weight *= trilinear.x * trilinear.y * trilinear.z;
    vec3 code = textureLod(color_atlas, tile_uv(v, block, normal, v.color_core, color_size), 0.0).rgb;
    light += weight * pow(code, vec3(2.5));  // Half of the gamma; the rest after mixing.
    sum += weight;
  }
  return sum > 0.0 ? (light / sum) * (light / sum) : vec3(0.0);
}
