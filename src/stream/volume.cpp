#include <gicodec/volume.h>

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

std::array<std::uint32_t, 3> sides(Grid grid) { return {grid.x, grid.y, grid.z}; }

/// The cell of a cage along one axis: its lower probe. A grid of one probe has cell 0 only.
std::uint32_t cell(float position, float origin, float spacing, std::uint32_t probes) {
  const float last = static_cast<float>(probes < 2 ? 0 : probes - 2);
  return static_cast<std::uint32_t>(
      std::clamp(std::floor((position - origin) / spacing), 0.0F, last));
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
  const bool positive =
      std::ranges::all_of(geometry.spacing, [](float spacing) { return spacing > 0; });
  return positive ? Status::ok : Status::invalid_argument;
}

void add_shading_probes(const VolumeGeometry& geometry, std::span<const Position> points,
                        std::span<std::uint8_t> mask) noexcept {
  const Grid grid = geometry.grid;
  const auto side = sides(grid);
  for (const Position& point : points) {
    if (!finite(point)) continue;
    std::array<std::uint32_t, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = cell(point[axis], geometry.origin[axis], geometry.spacing[axis], side[axis]);
      high[axis] = std::min(low[axis] + 1, side[axis] - 1);
    }
    for (std::uint32_t z = low[2]; z <= high[2]; ++z) {
      for (std::uint32_t y = low[1]; y <= high[1]; ++y) {
        for (std::uint32_t x = low[0]; x <= high[0]; ++x) {
          mask[x + std::size_t{grid.x} * (y + std::size_t{grid.y} * z)] = 1;
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
