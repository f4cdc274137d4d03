// Six irradiance vectors at each vertex of a grid (Pacanowski et al., section 3) as they arrive: an
// array of blocks of 6 records of 7 bytes, over the hemispheres +x, -x, +y, -y, +z, -z.

ByteAddressBuffer vectors : register(t0);  // tightly packed, to a whole word

// Four bytes from any address on.
uint word_at(uint at) {
  uint shift = (at & 3) * 8, word = vectors.Load(at & ~3u);
  return shift == 0 ? word : word >> shift | vectors.Load((at & ~3u) + 4) << (32 - shift);
}

// E5B9G9R9_UFLOAT_PACK32.
float3 color_of(uint record) {
  uint code = word_at(7 * record);
  float3 mantissas = float3(code & 511, code >> 9 & 511, code >> 18 & 511);
  return mantissas * exp2(float(code >> 27) - 24.0);
}

// R8G8B8_SNORM, behind the colour.
float3 direction_of(uint record) {
  int code = int(word_at(7 * record + 3));
  int3 codes = int3(code << 16, code << 8, code) >> 24;
  return max(float3(codes) / 127.0, -1.0);
}

// False where all bytes are zero: there is no light, as within a wall.
bool has_light(uint vertex) {
  uint bits = 0;
  for (uint record = 6 * vertex; record < 6 * vertex + 6; ++record) {
    bits |= word_at(7 * record) | word_at(7 * record + 3);
  }
  return bits != 0;
}

// Irradiance over pi on a surface at a vertex: of the hemispheres that the normal looks at, by the
// squares of its coordinates. Mix the vertices of a cell that have light as probes are.
float3 vector_light(uint vertex, float3 normal) {
  float3 light = 0;
  for (int axis = 0; axis < 3; ++axis) {
    uint record = 6 * vertex + 2 * axis + (normal[axis] >= 0 ? 0 : 1);
    float lit = max(dot(direction_of(record), normal), 0.0);
    light += normal[axis] * normal[axis] * lit * color_of(record);
  }
  return light;
}
