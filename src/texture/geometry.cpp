// Where blocks stand in the world.
#include "texture/cells.h"

#include <algorithm>

namespace gicodec {

Status validate(const VolumeGeometry& geometry) noexcept {
  std::uint64_t blocks = 1;
  for (const std::uint32_t side : sides(geometry.grid)) {
    if (side == 0 || side > kMaxBlocks || (blocks *= side) > kMaxBlocks) {
      return Status::invalid_geometry;
    }
  }
  if (!finite(geometry.origin) || !finite(geometry.spacing)) return Status::invalid_geometry;
  for (const std::int32_t cells : geometry.scroll) {
    if (cells < -kMaxScroll || cells > kMaxScroll) return Status::invalid_geometry;
  }
  const bool positive = std::all_of(geometry.spacing.begin(), geometry.spacing.end(),
                                    [](float spacing) { return spacing > 0; });
  return positive ? Status::ok : Status::invalid_geometry;
}

Position block_position(const VolumeGeometry& geometry, std::uint32_t block) noexcept {
  const Grid grid = geometry.grid;
  const std::array place{block % grid.x, block / grid.x % grid.y, block / (grid.x * grid.y)};
  Position position{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t cell = cell_at(place[axis], geometry.scroll[axis], sides(grid)[axis]);
    position[axis] = geometry.origin[axis] + static_cast<float>(cell) * geometry.spacing[axis];
  }
  return position;
}

std::vector<std::uint32_t> blocks_by_cell(const VolumeGeometry& geometry) {
  const Grid grid = geometry.grid;
  std::array<std::vector<std::uint32_t>, 3> places;  // By cell, along each axis.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t side = sides(grid)[axis];
    for (std::uint32_t i = 0; i < side; ++i) {
      places[axis].push_back(wrap(std::int64_t{geometry.scroll[axis]} + i, side));
    }
  }
  std::vector<std::uint32_t> blocks;
  for (const std::uint32_t z : places[2]) {
    for (const std::uint32_t y : places[1]) {
      for (const std::uint32_t x : places[0]) blocks.push_back(x + grid.x * (y + grid.y * z));
    }
  }
  return blocks;
}

Scroll scroll_to(const VolumeGeometry& geometry, const Position& viewer) noexcept {
  Scroll scroll{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cell = (double{viewer[axis]} - geometry.origin[axis]) / geometry.spacing[axis];
    const double first = std::round(cell - (sides(geometry.grid)[axis] - 1) / 2.0);
    scroll[axis] = static_cast<std::int32_t>(std::clamp<double>(first, -kMaxScroll, kMaxScroll));
  }
  return scroll;
}

std::vector<std::uint32_t> entering_blocks(Grid grid, const Scroll& from, const Scroll& to) {
  const auto side = sides(grid);
  std::array<std::vector<bool>, 3> moved;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t place = 0; place < side[axis]; ++place) {
      moved[axis].push_back(cell_at(place, from[axis], side[axis]) !=
                            cell_at(place, to[axis], side[axis]));
    }
  }
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t z = 0, block = 0; z < grid.z; ++z) {
    for (std::uint32_t y = 0; y < grid.y; ++y) {
      for (std::uint32_t x = 0; x < grid.x; ++x, ++block) {
        if (moved[0][x] || moved[1][y] || moved[2][z]) blocks.push_back(block);
      }
    }
  }
  return blocks;
}

}  // namespace gicodec
