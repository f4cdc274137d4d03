// Fields of vectors by chance, vertices as numbers, and what a client holds.
#pragma once

#include "vectors/vectors.h"

#include "ddgi/noise.h"

#include <gicodec/irradiance_vectors.h>

#include <array>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

namespace gicodec::vectors::test {

/// The numbers of a vertex.
using Numbers = std::array<float, 9 * kHemispheres>;
static_assert(sizeof(Vertex) == sizeof(Numbers));

inline Numbers numbers_of(const Vertex& vertex) { return std::bit_cast<Numbers>(vertex); }
inline Vertex vertex_of(const Numbers& numbers) { return std::bit_cast<Vertex>(numbers); }
inline bool same_bits(const Vertex& a, const Vertex& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

inline Vertex random_vertex(ddgi::Random& random) {
  Numbers numbers;
  for (float& number : numbers) number = random.in(-1, 2);
  return vertex_of(numbers);
}

/// Places as exact as floats are.
inline VolumeGeometry exact_geometry(Grid grid) { return {grid, {1, -2, 0.5F}, {0.5F, 2, 1}, {}}; }

/// All vertices are known with this share, at least one is.
inline VectorField random_field(Grid grid, float share, std::uint32_t seed) {
  ddgi::Random random(seed);
  VectorField field(exact_geometry(grid));
  for (std::size_t i = 0; i < field.vertices.size(); ++i) {
    field.vertices[i] = random_vertex(random);
    field.known[i] = random.next() < share ? 1 : 0;
  }
  field.known[seed % field.known.size()] = 1;
  return field;
}

inline Vec3 random_direction(ddgi::Random& random) {
  Vec3 d;
  do {
    d = {random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
  } while (!(dot(d, d) > 0.01F && dot(d, d) <= 1));
  return normalize(d);
}

/// A volume of vectors as a client holds it.
struct Held {
  VolumeDesc desc;
  VolumeGeometry geometry;
  std::vector<std::byte> texels;
  std::vector<std::uint8_t> received{};  ///< empty: all

  Held(const VolumeGeometry& geometry_in, bool floats, std::vector<std::byte> texels_in)
      : desc(*irradiance_vector_volume(geometry_in.grid, floats)),
        geometry(geometry_in),
        texels(std::move(texels_in)) {}
  explicit Held(const VectorServer& server)
      : Held(server.field().geometry, server.options().floats, server.texels()) {}

  [[nodiscard]] const TextureDesc& texture() const { return desc.groups[0].textures[0].desc; }
  void show(VectorLight& light) const {
    const kinds::HeldTexture held{"vectors", texture(), texels, received};
    light.update({desc, geometry, std::span(&held, 1)}, 0);
  }
};

/// What a light says at places in and around a box of 20 metres, with any normals.
inline std::vector<Vec3> picture(const VectorLight& light, std::uint32_t seed = 5) {
  ddgi::Random random(seed);
  std::vector<Vec3> out;
  for (int i = 0; i < 300; ++i) {
    ddgi::Surface surface;
    surface.position = {random.in(-10, 10), random.in(-10, 10), random.in(-10, 10)};
    surface.normal = random_direction(random);
    out.push_back(light.irradiance({surface, {}, 0, 0}));
  }
  return out;
}

}  // namespace gicodec::vectors::test
