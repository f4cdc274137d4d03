// Indirect light from probes (Majercik et al. 2019) as they arrive: an atlas_xy_z of blocks with a
// guard band of one texel, which lets hardware filter within a block without its neighbours.
// Colour is irradiance over pi, gamma-5 encoded in formats of unorm; visibility is mean distance
// and mean squared distance.

struct ProbeVolume {
  int3 grid;       // probes along each axis
  float3 origin;   // VolumeGeometry: of cell 0
  float3 spacing;
  int3 scroll;     // of this frame
  float color_core, visibility_core;  // texels of a block's side, without guard band
};

Texture2D<float4> color_atlas : register(t0);
Texture2D<float4> visibility_atlas : register(t1);
StructuredBuffer<uint> received : register(t2);  // per block: ClientTexture::changed is not 0
SamplerState linear_clamp : register(s0);        // linear filter, no mipmaps

// A unit direction in the square [-1, 1]^2.
float2 octahedral(float3 d) {
  float2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
  float2 side = float2(p.x >= 0 ? 1 : -1, p.y >= 0 ? 1 : -1);
  return d.z >= 0 ? p : (1 - abs(p.yx)) * side;
}

// The block of a cell: a volume that scrolls keeps each cell's block where it is.
int3 block_of(ProbeVolume v, int3 cell) {
  int3 rest = cell % v.grid;
  return int3(rest.x < 0 ? rest.x + v.grid.x : rest.x, rest.y < 0 ? rest.y + v.grid.y : rest.y,
              rest.z < 0 ? rest.z + v.grid.z : rest.z);
}

// Where a direction is in a block's tile of the atlas.
float2 tile_uv(ProbeVolume v, int3 block, float3 direction, float core, float2 size) {
  float2 tile = float2(block.x + v.grid.x * block.y, block.z) * (core + 2);
  return (tile + 1 + (octahedral(direction) * 0.5 + 0.5) * core) / size;
}

// Irradiance over pi at a position with a normal, seen from `to_viewer`.
float3 probe_light(ProbeVolume v, float3 position, float3 normal, float3 to_viewer) {
  float least = min(v.spacing.x, min(v.spacing.y, v.spacing.z));
  float3 biased = position + (normal * 0.2 + to_viewer * 0.8) * (0.225 * least);
  float3 at = clamp((biased - v.origin) / v.spacing, float3(v.scroll),
                    float3(v.scroll + v.grid - 1));
  int3 base = int3(floor(at));
  float3 alpha = at - float3(base);
  float2 color_size, visibility_size;
  color_atlas.GetDimensions(color_size.x, color_size.y);
  visibility_atlas.GetDimensions(visibility_size.x, visibility_size.y);
  float3 light = 0;
  float sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    int3 step = int3(corner & 1, corner >> 1 & 1, corner >> 2);
    int3 cell = min(base + step, v.scroll + v.grid - 1);
    int3 block = block_of(v, cell);
    // One that never came for the place where it stands is not black: it is left out.
    if (received[block.x + v.grid.x * (block.y + v.grid.y * block.z)] == 0) continue;
    float3 trilinear = lerp(1 - alpha, alpha, float3(step));
    float3 probe = v.origin + float3(cell) * v.spacing;
    float wrap = (dot(normalize(probe - position), normal) + 1) * 0.5;
    float weight = wrap * wrap + 0.2;
    float3 from_probe = biased - probe;
    float distance = max(length(from_probe), 1e-6);
    float2 uv = tile_uv(v, block, from_probe / distance, v.visibility_core, visibility_size);
    float2 moments = visibility_atlas.SampleLevel(linear_clamp, uv, 0).xy;
    if (distance > moments.x) {
      float variance = abs(moments.x * moments.x - moments.y);
      float beyond = distance - moments.x;
      float chebyshev = variance / (variance + beyond * beyond);
      weight *= chebyshev * chebyshev * chebyshev;
    }
    weight = max(weight, 1e-6);
    if (weight < 0.2) weight *= weight * weight / 0.04;
    weight *= trilinear.x * trilinear.y * trilinear.z;
    uv = tile_uv(v, block, normal, v.color_core, color_size);
    float3 code = color_atlas.SampleLevel(linear_clamp, uv, 0).rgb;
    light += weight * pow(code, 2.5);  // Half of the gamma; the rest after mixing.
    sum += weight;
  }
  return sum > 0 ? (light / sum) * (light / sum) : float3(0, 0, 0);
}
