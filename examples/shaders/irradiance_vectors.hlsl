// Six irradiance vectors at each vertex of a grid (Pacanowski et al., section 3) as they arrive:
// two arrays of blocks of 6 records, over the hemispheres +x, -x, +y, -y, +z, -z.

ByteAddressBuffer directions : register(t0);  // R8G8B8_SNORM, tightly packed, to a whole word
StructuredBuffer<uint> colors : register(t1);  // E5B9G9R9_UFLOAT_PACK32

int signed_byte(uint at) {
  uint word = directions.Load(at & ~3u);
  return int(word << (24 - (at & 3) * 8)) >> 24;
}

float3 direction_of(uint record) {
  int3 codes = int3(signed_byte(3 * record), signed_byte(3 * record + 1),
                    signed_byte(3 * record + 2));
  return max(float3(codes) / 127.0, -1.0);
}

float3 color_of(uint record) {
  uint code = colors[record];
  float3 mantissas = float3(code & 511, code >> 9 & 511, code >> 18 & 511);
  return mantissas * exp2(float(code >> 27) - 24.0);
}

// Irradiance over pi on a surface at a vertex: of the hemispheres that the normal looks at, by the
// squares of its coordinates. Mix the eight vertices of a cell as probes are.
float3 vector_light(uint vertex, float3 normal) {
  float3 light = 0;
  for (int axis = 0; axis < 3; ++axis) {
    uint record = 6 * vertex + 2 * axis + (normal[axis] >= 0 ? 0 : 1);
    float lit = max(dot(direction_of(record), normal), 0.0);
    light += normal[axis] * normal[axis] * lit * color_of(record);
  }
  return light;
}
