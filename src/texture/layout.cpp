// Where blocks lie in memory, and the sizes that follow from a description.
#include <gicodec/texture.h>

#include "texture/view.h"

#include <algorithm>
#include <array>

namespace gicodec {
namespace {

constexpr std::array<std::string_view, kTilingCount> kTilingNames{
    "atlas_xy_z",  "atlas_xz_y", "atlas_x_yz", "slices_xz_y",
    "slices_xy_z", "blocks",     "atlas_yz_x", "slices_yx_z"};

struct Place {
  std::uint64_t column, row, slice;
};

constexpr Place place(Tiling tiling, const Grid& n, std::uint64_t x, std::uint64_t y,
                      std::uint64_t z) {
  switch (tiling) {
    case Tiling::atlas_xy_z:
      return {x + n.x * y, z, 0};
    case Tiling::atlas_xz_y:
      return {x + n.x * z, y, 0};
    case Tiling::atlas_x_yz:
      return {x, y + n.y * z, 0};
    case Tiling::slices_xz_y:
      return {x, z, y};
    case Tiling::slices_xy_z:
      return {x, y, z};
    case Tiling::blocks:
      return {0, 0, 0};
    case Tiling::atlas_yz_x:
      return {y + n.y * z, x, 0};
    case Tiling::slices_yx_z:
      return {y, x, z};
  }
  return {};
}

/// Records of a tile along an axis.
constexpr std::uint64_t tile(const TextureDesc& desc, std::uint8_t side) {
  const unsigned padding = side > 1 ? desc.layout.pad_before + desc.layout.pad_after : 0U;
  return std::uint64_t{side} + padding;
}
constexpr std::uint64_t before(const TextureDesc& desc, std::uint8_t side) {
  return side > 1 ? desc.layout.pad_before : 0;
}
constexpr std::uint64_t guarded_side(const TextureDesc& desc, std::uint8_t side) {
  return tile(desc, side) + std::uint64_t{2} * desc.guard_band;
}

/// True where memory ends with the last record rather than with the last block.
constexpr bool is_clipped(const TextureDesc& desc) {
  return desc.records.x != 0 && desc.layout.tiling == Tiling::slices_xy_z;
}

}  // namespace

std::string_view to_string(Tiling tiling) noexcept {
  const auto index = static_cast<std::size_t>(tiling);
  return index < kTilingNames.size() ? kTilingNames[index] : std::string_view{};
}

Result<Tiling> tiling_from_string(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kTilingNames.size(); ++i) {
    if (kTilingNames[i] == name) return static_cast<Tiling>(i);
  }
  return Status::invalid_argument;
}

std::uint32_t block_count(const TextureDesc& desc) noexcept {
  return desc.grid.x * desc.grid.y * desc.grid.z;
}

Extent extent(const TextureDesc& desc) noexcept {
  if (is_clipped(desc)) return {desc.records.x, desc.records.y, desc.records.z};
  const Grid n = laid_out(desc);
  const Place last = place(desc.layout.tiling, n, n.x - 1, n.y - 1, n.z - 1);
  const std::uint64_t blocks = desc.layout.tiling == Tiling::blocks ? block_count(desc) : 1;
  return {(last.column + 1) * guarded_side(desc, desc.block.x),
          (last.row + 1) * guarded_side(desc, desc.block.y),
          (last.slice + 1) * tile(desc, desc.block.z) * blocks};
}

std::uint64_t texture_bytes(const TextureDesc& desc) noexcept {
  const auto size = extent(desc);
  return size.width * size.height * size.slices * desc.record.bytes;
}

BlockOrigin block_origin(const TextureDesc& desc, std::uint32_t block) noexcept {
  const Grid n = laid_out(desc);
  const std::uint64_t x = block % n.x, y = block / n.x % n.y, z = block / n.x / n.y;
  const Place at = place(desc.layout.tiling, n, x, y, z);
  return {at.column * guarded_side(desc, desc.block.x) + before(desc, desc.block.x),
          at.row * guarded_side(desc, desc.block.y) + before(desc, desc.block.y),
          at.slice * tile(desc, desc.block.z) + before(desc, desc.block.z),
          desc.layout.tiling == Tiling::blocks ? block : 0};
}

BlockShape block_inside(const TextureDesc& desc, std::uint32_t block) noexcept {
  if (desc.records.x == 0) return desc.block;
  const auto left = [](std::uint32_t records, std::uint32_t at, std::uint8_t side) {
    return static_cast<std::uint8_t>(std::min<std::uint32_t>(side, records - at * side));
  };
  const Grid& n = desc.grid;
  return {left(desc.records.x, block % n.x, desc.block.x),
          left(desc.records.y, block / n.x % n.y, desc.block.y),
          left(desc.records.z, block / n.x / n.y, desc.block.z)};
}

}  // namespace gicodec
