#include <gicodec/volume.h>

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

std::array<std::uint32_t, 3> sides(Grid grid) { return {grid.x, grid.y, grid.z}; }

/// c mod n, never negative.
std::uint32_t wrap(std::int64_t cell, std::uint32_t probes) {
  const auto n = static_cast<std::int64_t>(probes);
  return static_cast<std::uint32_t>((cell % n + n) % n);
}

/// The cell among scroll .. scroll + n − 1 whose block stands at a place of the texture.
std::int64_t cell_at(std::uint32_t place, std::int32_t scroll, std::uint32_t probes) {
  return scroll + std::int64_t{wrap(std::int64_t{place} - scroll, probes)};
}

/// The lower cell of the cage around a position. An axis of one probe has one cell only.
std::int64_t cage_cell(float position, const VolumeGeometry& geometry, std::size_t axis) {
  const std::uint32_t probes = sides(geometry.grid)[axis];
  const auto first = static_cast<double>(geometry.scroll[axis]);
  const double last = first + (probes < 2 ? 0 : probes - 2);
  const double cell = (double{position} - geometry.origin[axis]) / geometry.spacing[axis];
  return static_cast<std::int64_t>(std::clamp(std::floor(cell), first, last));
}

bool finite(const Position& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

}  // namespace

Status validate(const VolumeGeometry& geometry) noexcept {
  std::uint64_t probes = 1;
  for (const std::uint32_t side : sides(geometry.grid)) {
    if (side == 0 || side > kMaxProbes || (probes *= side) > kMaxProbes) {
      return Status::invalid_argument;
    }
  }
  if (!finite(geometry.origin) || !finite(geometry.spacing)) return Status::invalid_argument;
  for (const std::int32_t cells : geometry.scroll) {
    if (cells < -kMaxScroll || cells > kMaxScroll) return Status::invalid_argument;
  }
  const bool positive = std::all_of(geometry.spacing.begin(), geometry.spacing.end(),
                                    [](float spacing) { return spacing > 0; });
  return positive ? Status::ok : Status::invalid_argument;
}

Position probe_position(const VolumeGeometry& geometry, std::uint32_t probe) noexcept {
  const Grid grid = geometry.grid;
  const std::array place{probe % grid.x, probe / grid.x % grid.y, probe / (grid.x * grid.y)};
  Position position{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t cell = cell_at(place[axis], geometry.scroll[axis], sides(grid)[axis]);
    position[axis] = geometry.origin[axis] + static_cast<float>(cell) * geometry.spacing[axis];
  }
  return position;
}

std::vector<std::uint32_t> probes_by_cell(const VolumeGeometry& geometry) {
  const Grid grid = geometry.grid;
  std::array<std::vector<std::uint32_t>, 3> places;  // By cell, along each axis.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t side = sides(grid)[axis];
    for (std::uint32_t i = 0; i < side; ++i) {
      places[axis].push_back(wrap(std::int64_t{geometry.scroll[axis]} + i, side));
    }
  }
  std::vector<std::uint32_t> probes;
  for (const std::uint32_t z : places[2]) {
    for (const std::uint32_t y : places[1]) {
      for (const std::uint32_t x : places[0]) probes.push_back(x + grid.x * (y + grid.y * z));
    }
  }
  return probes;
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

std::vector<std::uint32_t> entering_probes(Grid grid, const Scroll& from, const Scroll& to) {
  const auto side = sides(grid);
  std::array<std::vector<bool>, 3> moved;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t place = 0; place < side[axis]; ++place) {
      moved[axis].push_back(cell_at(place, from[axis], side[axis]) !=
                            cell_at(place, to[axis], side[axis]));
    }
  }
  std::vector<std::uint32_t> probes;
  for (std::uint32_t z = 0, probe = 0; z < grid.z; ++z) {
    for (std::uint32_t y = 0; y < grid.y; ++y) {
      for (std::uint32_t x = 0; x < grid.x; ++x, ++probe) {
        if (moved[0][x] || moved[1][y] || moved[2][z]) probes.push_back(probe);
      }
    }
  }
  return probes;
}

void add_shading_probes(const VolumeGeometry& geometry, std::span<const Position> points,
                        std::span<std::uint8_t> mask) noexcept {
  const auto side = sides(geometry.grid);
  for (const Position& point : points) {
    if (!finite(point)) continue;
    std::array<std::array<std::uint32_t, 2>, 3> places{};  // Of the lower and the upper cell.
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

Grid ChunkGrid::first_of(std::uint32_t chunk) const noexcept {
  return {chunk % count_.x * size_.x, chunk / count_.x % count_.y * size_.y,
          chunk / (count_.x * count_.y) * size_.z};
}

Grid ChunkGrid::grid_of(std::uint32_t chunk) const noexcept {
  const Grid first = first_of(chunk);
  return {std::min(size_.x, grid_.x - first.x), std::min(size_.y, grid_.y - first.y),
          std::min(size_.z, grid_.z - first.z)};
}

std::uint32_t ChunkGrid::chunk_of(std::uint32_t probe) const noexcept {
  const std::uint32_t x = probe % grid_.x, y = probe / grid_.x % grid_.y,
                      z = probe / (grid_.x * grid_.y);
  return x / size_.x + count_.x * (y / size_.y + count_.y * (z / size_.z));
}

std::vector<std::uint32_t> ChunkGrid::probes_of(std::uint32_t chunk) const {
  const Grid first = first_of(chunk), size = grid_of(chunk);
  std::vector<std::uint32_t> probes;
  probes.reserve(std::size_t{size.x} * size.y * size.z);
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t y = 0; y < size.y; ++y) {
      for (std::uint32_t x = 0; x < size.x; ++x) {
        probes.push_back(first.x + x + grid_.x * (first.y + y + grid_.y * (first.z + z)));
      }
    }
  }
  return probes;
}

}  // namespace gicodec
