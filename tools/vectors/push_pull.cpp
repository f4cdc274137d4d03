#include "push_pull.h"

#include <algorithm>
#include <utility>

namespace gicodec::vectors {
namespace {

/// A level of the pyramid.
struct Level {
  Grid grid;
  std::vector<Vertex> vertices;
  std::vector<std::uint8_t> known;

  [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + grid.x * (y + std::size_t{grid.y} * z);
  }
};

void add(Vertex& sum, const Vertex& value, float weight) {
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    sum[h].red += value[h].red * weight;
    sum[h].green += value[h].green * weight;
    sum[h].blue += value[h].blue * weight;
  }
}
Vertex scaled(const Vertex& value, float factor) {
  Vertex out{};
  add(out, value, factor);
  return out;
}

/// body(x, y, z, index) for each vertex.
template <typename Body>
void for_each(const Level& level, const Body& body) {
  std::size_t index = 0;
  for (std::uint32_t z = 0; z < level.grid.z; ++z) {
    for (std::uint32_t y = 0; y < level.grid.y; ++y) {
      for (std::uint32_t x = 0; x < level.grid.x; ++x) body(x, y, z, index++);
    }
  }
}

/// A coarser level: each vertex the mean of those known of up to eight.
Level pull(const Level& fine) {
  const auto halved = [](std::uint32_t vertices) { return (vertices + 1) / 2; };
  Level coarse{{halved(fine.grid.x), halved(fine.grid.y), halved(fine.grid.z)}, {}, {}};
  coarse.vertices.resize(std::size_t{coarse.grid.x} * coarse.grid.y * coarse.grid.z);
  coarse.known.resize(coarse.vertices.size());
  for_each(fine, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, std::size_t at) {
    if (fine.known[at] == 0) return;
    const std::size_t to = coarse.index(x / 2, y / 2, z / 2);
    add(coarse.vertices[to], fine.vertices[at], 1);
    ++coarse.known[to];
  });
  for (std::size_t i = 0; i < coarse.vertices.size(); ++i) {
    if (coarse.known[i] > 0)
      coarse.vertices[i] = scaled(coarse.vertices[i], 1.0F / static_cast<float>(coarse.known[i]));
  }
  return coarse;
}

/// Vertices of a coarser level around a place of a finer one, along an axis: three quarters of the
/// nearer one.
struct Pair {
  std::uint32_t near, far;
};
Pair parents(std::uint32_t at, std::uint32_t coarse) {
  const std::uint32_t near = at / 2;
  const std::uint32_t far =
      at % 2 == 0 ? (near > 0 ? near - 1 : 0) : std::min(near + 1, coarse - 1);
  return {near, far};
}

/// Trilinear, from a level all of which has values.
Vertex refined(const Level& coarse, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const Pair px = parents(x, coarse.grid.x), py = parents(y, coarse.grid.y),
             pz = parents(z, coarse.grid.z);
  constexpr float kNear = 0.75F, kFar = 0.25F;
  Vertex sum{};
  for (unsigned i = 0; i < 8; ++i) {
    const bool fx = (i & 1) != 0, fy = (i & 2) != 0, fz = (i & 4) != 0;
    const std::size_t at =
        coarse.index(fx ? px.far : px.near, fy ? py.far : py.near, fz ? pz.far : pz.near);
    add(sum, coarse.vertices[at], (fx ? kFar : kNear) * (fy ? kFar : kNear) * (fz ? kFar : kNear));
  }
  return sum;
}

/// What is not known, by what is around it: weights 1, 2, 1 along each axis.
void filter(Level& level) {
  const std::vector<Vertex> before = level.vertices;
  for_each(level, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, std::size_t at) {
    if (level.known[at] != 0) return;
    Vertex sum{};
    float weights = 0;
    for (std::int32_t dz = -1; dz <= 1; ++dz) {
      for (std::int32_t dy = -1; dy <= 1; ++dy) {
        for (std::int32_t dx = -1; dx <= 1; ++dx) {
          // Beyond an edge this wraps around, and is too large.
          const std::uint32_t nx = x + static_cast<std::uint32_t>(dx),
                              ny = y + static_cast<std::uint32_t>(dy),
                              nz = z + static_cast<std::uint32_t>(dz);
          if (nx >= level.grid.x || ny >= level.grid.y || nz >= level.grid.z) continue;
          const float weight = static_cast<float>((2 - dx * dx) * (2 - dy * dy) * (2 - dz * dz));
          add(sum, before[level.index(nx, ny, nz)], weight);
          weights += weight;
        }
      }
    }
    level.vertices[at] = scaled(sum, 1 / weights);
  });
}

/// Fills in what a level lacks.
void push(const Level& coarse, Level& fine, bool smooth) {
  for_each(fine, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, std::size_t at) {
    if (fine.known[at] == 0) fine.vertices[at] = refined(coarse, x, y, z);
  });
  if (smooth) filter(fine);
}

}  // namespace

void push_pull(VectorField& field, bool smooth) {
  const auto is_known = [](std::uint8_t known) { return known != 0; };
  if (std::ranges::none_of(field.known, is_known) || std::ranges::all_of(field.known, is_known)) {
    return;
  }
  std::vector<Level> levels;
  levels.push_back({field.geometry.grid, std::move(field.vertices), std::move(field.known)});
  while (levels.back().vertices.size() > 1) levels.push_back(pull(levels.back()));
  for (std::size_t i = levels.size() - 1; i-- > 0;) push(levels[i + 1], levels[i], smooth);
  field.vertices = std::move(levels[0].vertices);
  field.known.assign(field.vertices.size(), 1);
}

}  // namespace gicodec::vectors
