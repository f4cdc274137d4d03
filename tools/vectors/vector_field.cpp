#include "vector_field.h"

#include <algorithm>

namespace gicodec::vectors {
namespace {

constexpr float kMinWeight = 1e-20F;  // less could not be divided by

/// Vertices along one axis and their weights.
struct Taps {
  unsigned count = 0;
  std::array<std::uint32_t, 4> at{};
  std::array<float, 4> weight{};
};

Taps taps_of(float place, std::uint32_t vertices, Interpolation interpolation) {
  const float last = static_cast<float>(vertices - 1);
  place = place > 0 ? std::min(place, last) : 0;  // also what is no number
  const auto cell = static_cast<std::uint32_t>(place);
  const float t = place - static_cast<float>(cell), s = 1 - t;
  const auto clamped = [vertices](std::uint32_t i) { return std::min(i, vertices - 1); };
  if (interpolation == Interpolation::trilinear) {
    return {2, {cell, clamped(cell + 1)}, {s, t}};
  }
  return {4,
          {cell > 0 ? cell - 1 : 0, cell, clamped(cell + 1), clamped(cell + 2)},
          {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
           t * t * t / 6}};
}

}  // namespace

Vec3 VectorField::irradiance(Vec3 position, Vec3 normal, Interpolation interpolation) const {
  const Grid& grid = geometry.grid;
  const auto along = [&](float p, std::size_t axis, std::uint32_t count) {
    return taps_of((p - geometry.origin[axis]) / geometry.spacing[axis], count, interpolation);
  };
  const Taps x = along(position.x, 0, grid.x), y = along(position.y, 1, grid.y),
             z = along(position.z, 2, grid.z);
  const std::array<std::size_t, 3> hemisphere{normal.x >= 0 ? std::size_t{0} : 1,
                                              normal.y >= 0 ? std::size_t{2} : 3,
                                              normal.z >= 0 ? std::size_t{4} : 5};
  const std::array<float, 3> share{normal.x * normal.x, normal.y * normal.y, normal.z * normal.z};
  Vec3 sum;
  float weights = 0;
  for (unsigned k = 0; k < z.count; ++k) {
    for (unsigned j = 0; j < y.count; ++j) {
      const std::size_t row = grid.x * (y.at[j] + std::size_t{grid.y} * z.at[k]);
      for (unsigned i = 0; i < x.count; ++i) {
        const float weight = x.weight[i] * y.weight[j] * z.weight[k];
        const std::size_t at = row + x.at[i];
        if (!(weight > kMinWeight) || known[at] == 0) continue;
        for (std::size_t h = 0; h < hemisphere.size(); ++h) {
          sum += vertices[at][hemisphere[h]].along(normal) * (weight * share[h]);
        }
        weights += weight;
      }
    }
  }
  return weights > 0 ? max(sum / weights, {}) : Vec3{};
}

}  // namespace gicodec::vectors
