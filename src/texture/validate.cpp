// What makes a texture's description invalid.
#include <gicodec/texture.h>

#include <initializer_list>

namespace gicodec {
namespace {

constexpr bool in_range(std::uint64_t value, std::uint64_t most) {
  return value >= 1 && value <= most;
}

/// Each side in range; their product, too. A product of two sides fits.
constexpr bool in_range(const Grid& grid, std::uint64_t most_side, std::uint64_t most) {
  if (!in_range(grid.x, most_side) || !in_range(grid.y, most_side) ||
      !in_range(grid.z, most_side)) {
    return false;
  }
  const std::uint64_t plane = std::uint64_t{grid.x} * grid.y;
  return plane <= most && plane * grid.z <= most;
}

std::string_view problem_of_block(const TextureDesc& desc) {
  const BlockShape& block = desc.block;
  if (!in_range({block.x, block.y, block.z}, kMaxBlockSide, kMaxBlockRecords)) {
    return "block: each side is 1 to 64, their product at most 32768";
  }
  if (desc.guard_band > 1) return "guard_band: it is 0 or 1";
  if (desc.guard_band == 1 && (block.x != block.y || block.z != 1)) {
    return "guard_band: a block with one is square and of depth 1";
  }
  return {};
}

std::string_view problem_of_layout(const TextureDesc& desc) {
  const Layout& layout = desc.layout;
  if (static_cast<std::uint8_t>(layout.tiling) >= kTilingCount) return "tiling: unknown";
  if (layout.pad_before > kMaxPadding) return "pad_before: it is 0 to 8";
  if (layout.pad_after > kMaxPadding) return "pad_after: it is 0 to 8";
  return {};
}

std::string_view problem_of_pool(const TextureDesc& desc) {
  const Grid& grid = desc.grid;
  if (grid.y != 1 || grid.z != 1 || !in_range(grid.x, kMaxBlocks)) {
    return "grid: that of a pool is slots, 1, 1, with 1 to 16777216 slots";
  }
  if (desc.records != Grid{}) return "records: zeros for a pool";
  const Grid& slots = desc.layout.slots;
  if (slots == Grid{}) return {};
  if (!in_range(slots, kMaxBlocks, kMaxBlocks)) {
    return "slots: all zeros, or a product of 1 to 16777216";
  }
  if (std::uint64_t{slots.x} * slots.y * slots.z < grid.x) return "slots: fewer than the grid's";
  return {};
}

std::string_view problem_of_records(const TextureDesc& desc) {
  const Grid &records = desc.records, &grid = desc.grid;
  if (records == Grid{}) return {};
  if (desc.guard_band != 0) return "records: zeros for blocks with a guard band";
  if (desc.layout.pad_before != 0 || desc.layout.pad_after != 0) {
    return "records: zeros for blocks with padding";
  }
  const auto reaches_last = [](std::uint64_t size, std::uint64_t blocks, std::uint64_t side) {
    return size > (blocks - 1) * side && size <= blocks * side;
  };
  if (!reaches_last(records.x, grid.x, desc.block.x) ||
      !reaches_last(records.y, grid.y, desc.block.y) ||
      !reaches_last(records.z, grid.z, desc.block.z)) {
    return "records: along each axis they end in the grid's last block, or all are zeros";
  }
  return {};
}

std::string_view problem_of_grid(const TextureDesc& desc) {
  if (desc.layout.slots != Grid{}) return "slots: zeros for a grid";
  if (!in_range(desc.grid, kMaxGridSide, kMaxBlocks)) {
    return "grid: each side is 1 to 65535, their product at most 16777216";
  }
  return problem_of_records(desc);
}

std::string_view problem_of_space(const TextureDesc& desc) {
  switch (desc.space) {
    case Space::grid:
      return problem_of_grid(desc);
    case Space::pool:
      return problem_of_pool(desc);
  }
  return "space: unknown";
}

/// Six records for each of n³ voxels.
bool is_brick(const BlockShape& block) {
  const std::uint8_t n = block.y;
  return (n == 2 || n == 4 || n == 8) && block.z == n && block.x == kVoxelDirections * n;
}

bool is_hemispheres(const TextureDesc& desc) {
  return desc.space == Space::grid && desc.block == BlockShape{6, 1, 1} &&
         desc.presence == Presence::all &&
         (desc.record == colored_direction(false) || desc.record == colored_direction(true));
}

std::string_view problem_of_model(const TextureDesc& desc) {
  if (desc.presence > Presence::brick) return "presence: unknown";
  if ((desc.presence == Presence::brick) != (desc.model == Model::octree)) {
    return "presence: brick and the model octree need each other";
  }
  const bool plain = desc.guard_band == 0 && desc.records == Grid{};
  switch (desc.model) {
    case Model::none:
      return {};
    case Model::stacked:
    case Model::continuous:
      if (desc.space == Space::grid) return {};
      return "model: blocks of a pool have no neighbours; none and unordered suit one";
    case Model::unordered:
      if (plain && desc.presence != Presence::mask) return {};
      return "model: unordered needs presence all or count, full blocks, no guard band";
    case Model::octree:
      if (desc.space == Space::pool && is_brick(desc.block)) return {};
      return "model: octree needs a pool of blocks of 6n × n × n, n 2, 4 or 8";
    case Model::hemispheres:
      if (plain && is_hemispheres(desc)) return {};
      return "model: hemispheres needs a grid of full blocks of 6 × 1 × 1 colored directions";
  }
  return "model: unknown";
}

/// Sums of a few such sizes must not overflow.
bool fits_machine(const TextureDesc& desc) { return texture_bytes(desc) <= SIZE_MAX / 16; }

/// On any machine.
std::string_view problem_anywhere(const TextureDesc& desc) {
  if (!is_valid(desc.record)) {
    return "format: unknown; where it is 0, components that overlap or are none";
  }
  for (const auto part :
       {problem_of_block, problem_of_layout, problem_of_space, problem_of_model}) {
    if (const std::string_view found = part(desc); !found.empty()) return found;
  }
  return {};
}

}  // namespace

std::string_view problem(const TextureDesc& desc) noexcept {
  if (const std::string_view found = problem_anywhere(desc); !found.empty()) return found;
  return fits_machine(desc) ? "" : "grid: a 32-bit program takes textures below 256 MiB";
}

Status validate(const TextureDesc& desc) noexcept {
  if (!is_valid(desc.record)) return Status::unsupported_format;
  if (!problem_anywhere(desc).empty()) return Status::invalid_description;
  return fits_machine(desc) ? Status::ok : Status::limit_exceeded;
}

}  // namespace gicodec
