// Six irradiance vectors at each vertex of a grid (Pacanowski et al., section 3) as they arrive: an
// array of blocks of 6 records of 7 bytes, over the hemispheres +x, -x, +y, -y, +z, -z.

layout(std430, binding = 0) readonly buffer Vectors {
  uint vector_words[];  // tightly packed, and bytes to the end of the last word
};

// Four bytes from any address on.
uint word_at(uint at) {
  uint shift = (at & 3u) * 8u, word = vector_words[at >> 2];
  return shift == 0u ? word : word >> shift | vector_words[(at >> 2) + 1u] << (32u - shift);
}

// E5B9G9R9_UFLOAT_PACK32.
vec3 color_of(uint record) {
  uint code = word_at(7u * record);
  vec3 mantissas = vec3(code & 511u, code >> 9 & 511u, code >> 18 & 511u);
  return mantissas * exp2(float(code >> 27) - 24.0);
}

// R8G8B8_SNORM, behind the colour.
vec3 direction_of(uint record) {
  int code = int(word_at(7u * record + 3u));
  ivec3 codes = ivec3(bitfieldExtract(code, 8, 8), bitfieldExtract(code, 16, 8), code >> 24);
  return max(vec3(codes) / 127.0, vec3(-1.0));
}

// False where all bytes are zero: there is no light, as within a wall.
bool has_light(uint vertex) {
  uint bits = 0u;
  for (uint record = 6u * vertex; record < 6u * vertex + 6u; ++record) {
    bits |= word_at(7u * record) | word_at(7u * record + 3u);
  }
  return bits != 0u;
}

// Irradiance over pi on a surface at a vertex: of the hemispheres that the normal looks at, by the
// squares of its coordinates. Mix the vertices of a cell that have light as probes are.
vec3 vector_light(uint vertex, vec3 normal) {
  vec3 light = vec3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    uint record = 6u * vertex + 2u * uint(axis) + (normal[axis] >= 0.0 ? 0u : 1u);
    float lit = max(dot(direction_of(record), normal), 0.0);
    light += normal[axis] * normal[axis] * lit * color_of(record);
  }
  return light;
}
