// Which probes shade given points.
#include <gicodec/probes.h>

#include "texture/cells.h"

#include <algorithm>

namespace gicodec {
namespace {

/// The lower cell of the cage around a position, along an axis. An axis of one block has one cell.
std::int64_t cage_cell(float position, const VolumeGeometry& geometry, std::size_t axis) {
  const std::uint32_t blocks = sides(geometry.grid)[axis];
  const auto first = static_cast<double>(geometry.scroll[axis]);
  const double last = first + (blocks < 2 ? 0 : blocks - 2);
  const double cell = (double{position} - geometry.origin[axis]) / geometry.spacing[axis];
  return static_cast<std::int64_t>(std::clamp(std::floor(cell), first, last));
}

}  // namespace

void add_shading_probes(const VolumeGeometry& geometry, std::span<const Position> points,
                        std::span<std::uint8_t> mask) noexcept {
  const auto side = sides(geometry.grid);
  for (const Position& point : points) {
    if (!finite(point)) continue;
    std::array<std::array<std::uint32_t, 2>, 3>
        places{};  // of the lower and the upper cell, per axis
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t cell = cage_cell(point[axis], geometry, axis);
      places[axis] = {wrap(cell, side[axis]), wrap(side[axis] < 2 ? cell : cell + 1, side[axis])};
    }
    for (const std::uint32_t z : places[2]) {
      for (const std::uint32_t y : places[1]) {
        for (const std::uint32_t x : places[0]) {
          mask[x + std::size_t{side[0]} * (y + std::size_t{side[1]} * z)] = 1;
        }
      }
    }
  }
}

}  // namespace gicodec
