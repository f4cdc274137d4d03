// Voxels of a sparse octree (Crassin et al., section 4.1) as they arrive: both textures of `voxels`,
// bricks of 4^3 in shared exponents, each an array of blocks; and the order of their slots.

// Of a slot Morton key and level, two words, and the mask, two more.
StructuredBuffer<uint> bricks : register(t0);
// Of a slot 4^3 voxels, x lowest, of six directions: +x, -x, +y, -y, +z, -z.
StructuredBuffer<uint> light : register(t1);
// How many, and received slots whose mask is not zero, by their second word, then their first; of
// those alike only the lowest.
StructuredBuffer<uint> order : register(t2);

// Every third bit, of a number of 10 bits.
uint spread_bits(uint x) {
  x = (x | x << 16) & 0x030000FFu;
  x = (x | x << 8) & 0x0300F00Fu;
  x = (x | x << 4) & 0x030C30C3u;
  return (x | x << 2) & 0x09249249u;
}

// The first two words of a brick: coordinates, below 2^18, by their bits in turn,
// and the level from bit 56 on.
uint2 brick_place(uint level, uint3 at) {
  uint3 low = at & 1023, high = at >> 10;
  uint first = spread_bits(low.x) | spread_bits(low.y) << 1 | spread_bits(low.z) << 2;
  uint second = spread_bits(high.x) | spread_bits(high.y) << 1 | spread_bits(high.z) << 2;
  return uint2(first | second << 30, second >> 2 | level << 24);
}

// The slot of a brick; ~0 if there is none.
uint find_brick(uint level, uint3 at) {
  uint2 place = brick_place(level, at);
  uint begin = 0, end = order[0];
  while (begin < end) {
    uint middle = (begin + end) / 2, slot = order[1 + middle];
    uint2 there = uint2(bricks[4 * slot], bricks[4 * slot + 1]);
    if (all(there == place)) return slot;
    if (there.y < place.y || (there.y == place.y && there.x < place.x)) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return ~0u;
}

// E5B9G9R9_UFLOAT_PACK32.
float3 voxel_color(uint code) {
  float3 mantissas = float3(code & 511, code >> 9 & 511, code >> 18 & 511);
  return mantissas * exp2(float(code >> 27) - 24.0);
}

// Irradiance over pi on a surface, by the voxels of a level around it: of the three directions that
// the normal looks at, by the squares of its coordinates. What does not exist, or is zero, buried
// or looked at by no surface, does not count. `place`: (position - origin) / spacing. Alpha is 0
// where there is no voxel: take the next level. It is black where there are some, and none has
// light the way the normal looks. Between levels, mix two.
float4 voxel_light(float3 place, float3 normal, uint level) {
  float3 at = place * exp2(-float(level)) - 0.5, whole = floor(at), fraction = at - whole;
  float3 color[3] = {float3(0, 0, 0), float3(0, 0, 0), float3(0, 0, 0)};
  float weight[3] = {0, 0, 0};
  float found = 0;
  for (int i = 0; i < 8; ++i) {
    int3 corner = int3(i & 1, i >> 1 & 1, i >> 2), cell = int3(whole) + corner;
    float3 near = lerp(1.0 - fraction, fraction, float3(corner));
    float share = near.x * near.y * near.z;
    if (any(cell < 0) || share <= 1e-6) continue;
    uint slot = find_brick(level, uint3(cell) >> 2);
    if (slot == ~0u) continue;
    uint voxel = uint(cell.x & 3) | uint(cell.y & 3) << 2 | uint(cell.z & 3) << 4;
    if ((bricks[4 * slot + 2 + (voxel >> 5)] >> (voxel & 31) & 1) == 0) continue;
    found = 1;
    for (int axis = 0; axis < 3; ++axis) {
      uint side = 2 * axis + (normal[axis] >= 0 ? 0 : 1);
      float3 one = voxel_color(light[6 * (64 * slot + voxel) + side]);
      if (all(one == 0)) continue;
      color[axis] += share * one;
      weight[axis] += share;
    }
  }
  float4 sum = 0;
  for (int side = 0; side < 3; ++side) {
    if (weight[side] == 0) continue;
    float share = normal[side] * normal[side];
    sum += float4(color[side] * (share / weight[side]), share);
  }
  return float4(sum.rgb / max(sum.a, 1e-6), found);
}
