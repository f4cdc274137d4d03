// Six irradiance vectors at each vertex of a grid (Pacanowski et al., section 3) as they arrive:
// two arrays of blocks of 6 records, over the hemispheres +x, -x, +y, -y, +z, -z.

layout(std430, binding = 0) readonly buffer Directions {
  uint direction_words[];  // R8G8B8_SNORM, tightly packed, and bytes to the end of the last word
};
layout(std430, binding = 1) readonly buffer Colors {
  uint colors[];  // E5B9G9R9_UFLOAT_PACK32
};

int signed_byte(uint at) {
  return bitfieldExtract(int(direction_words[at >> 2]), int(at & 3u) * 8, 8);
}

vec3 direction_of(uint record) {
  ivec3 codes = ivec3(signed_byte(3u * record), signed_byte(3u * record + 1u),
                      signed_byte(3u * record + 2u));
  return max(vec3(codes) / 127.0, vec3(-1.0));
}

vec3 color_of(uint record) {
  uint code = colors[record];
  vec3 mantissas = vec3(code & 511u, code >> 9 & 511u, code >> 18 & 511u);
  return mantissas * exp2(float(code >> 27) - 24.0);
}

// Irradiance over pi on a surface at a vertex: of the hemispheres that the normal looks at, by the
// squares of its coordinates. Mix the eight vertices of a cell as probes are.
vec3 vector_light(uint vertex, vec3 normal) {
  vec3 light = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    uint record = 6u * vertex + 2u * uint(axis) + (normal[axis] >= 0.0 ? 0u : 1u);
    float lit = max(dot(direction_of(record), normal), 0.0);
    light += normal[axis] * normal[axis] * lit * color_of(record);
  }
  return light;
}
