// Voxels of a sparse octree (Crassin et al., section 4.1) as they arrive: both textures of `voxels`,
// bricks of 4^3 in shared exponents, each an array of blocks; and the order of their slots.

layout(std430, binding = 0) readonly buffer Bricks {
  uint bricks[];  // of a slot Morton key and level, two words, and the mask, two more
};
layout(std430, binding = 1) readonly buffer Light {
  uint light[];  // of a slot 4^3 voxels, x lowest, of six directions: +x, -x, +y, -y, +z, -z
};
layout(std430, binding = 2) readonly buffer Order {
  uint order_count;
  // Received slots whose mask is not zero, by their second word, then their first; of those alike
  // only the lowest.
  uint order[];
};

// Every third bit, of a number of 10 bits.
uint spread_bits(uint x) {
  x = (x | x << 16) & 0x030000FFu;
  x = (x | x << 8) & 0x0300F00Fu;
  x = (x | x << 4) & 0x030C30C3u;
  return (x | x << 2) & 0x09249249u;
}

// The first two words of a brick: coordinates, below 2^18, by their bits in turn,
// and the level from bit 56 on.
uvec2 brick_place(uint level, uvec3 at) {
  uvec3 low = at & 1023u, high = at >> 10;
  uint first = spread_bits(low.x) | spread_bits(low.y) << 1 | spread_bits(low.z) << 2;
  uint second = spread_bits(high.x) | spread_bits(high.y) << 1 | spread_bits(high.z) << 2;
  return uvec2(first | second << 30, second >> 2 | level << 24);
}

// The slot of a brick; ~0 if there is none.
uint find_brick(uint level, uvec3 at) {
  uvec2 place = brick_place(level, at);
  uint begin = 0u, end = order_count;
  while (begin < end) {
    uint middle = (begin + end) / 2u, slot = order[middle];
    uvec2 there = uvec2(bricks[4u * slot], bricks[4u * slot + 1u]);
    if (there == place) return slot;
    if (there.y < place.y || (there.y == place.y && there.x < place.x)) {
      begin = middle + 1u;
    } else {
      end = middle;
    }
  }
  return ~0u;
}

// E5B9G9R9_UFLOAT_PACK32.
vec3 voxel_color(uint code) {
  vec3 mantissas = vec3(code & 511u, code >> 9 & 511u, code >> 18 & 511u);
  return mantissas * exp2(float(code >> 27) - 24.0);
}

// Irradiance over pi on a surface, by the voxels of a level around it: of the three directions that
// the normal looks at, by the squares of its coordinates. What does not exist, or is zero, buried
// or looked at by no surface, does not count. `place`: (position - origin) / spacing. Alpha is 0
// where there is no voxel: take the next level. It is black where there are some, and none has
// light the way the normal looks. Between levels, mix two.
vec4 voxel_light(vec3 place, vec3 normal, uint level) {
  vec3 at = place * exp2(-float(level)) - 0.5, whole = floor(at), fraction = at - whole;
  mat3 color = mat3(0.0);
  vec3 weight = vec3(0.0);
  float found = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2), cell = ivec3(whole) + corner;
    vec3 near = mix(1.0 - fraction, fraction, vec3(corner));
    float share = near.x * near.y * near.z;
    if (any(lessThan(cell, ivec3(0))) || share <= 1e-6) continue;
    uint slot = find_brick(level, uvec3(cell) >> 2);
    if (slot == ~0u) continue;
    uint voxel = uint(cell.x & 3) | uint(cell.y & 3) << 2 | uint(cell.z & 3) << 4;
    if ((bricks[4u * slot + 2u + (voxel >> 5)] >> (voxel & 31u) & 1u) == 0u) continue;
    found = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      uint side = 2u * uint(axis) + (normal[axis] >= 0.0 ? 0u : 1u);
      vec3 one = voxel_color(light[6u * (64u * slot + voxel) + side]);
      if (one == vec3(0.0)) continue;
      color[axis] += share * one;
      weight[axis] += share;
    }
  }
  vec4 sum = vec4(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (weight[axis] == 0.0) continue;
    float share = normal[axis] * normal[axis];
    sum += vec4(color[axis] * (share / weight[axis]), share);
  }
  return vec4(sum.rgb / max(sum.a, 1e-6), found);
}
