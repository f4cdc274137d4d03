// Volume geometry: grid to texture and the sizes that follow from a description.
#include <gicodec/texture.h>

#include <array>

namespace gicodec {
namespace {

constexpr std::array<std::string_view, kTilingCount> kTilingNames{
    "atlas_xy_z", "atlas_xz_y", "atlas_x_yz", "slices_xz_y", "slices_xy_z"};

struct Tiles {
  std::uint64_t columns, rows, slices;
};

constexpr Tiles tiles(const TextureDesc& desc) {
  const std::uint64_t x = desc.grid.x, y = desc.grid.y, z = desc.grid.z;
  switch (desc.tiling) {
    case Tiling::atlas_xy_z:
      return {x * y, z, 1};
    case Tiling::atlas_xz_y:
      return {x * z, y, 1};
    case Tiling::atlas_x_yz:
      return {x, y * z, 1};
    case Tiling::slices_xz_y:
      return {x, z, y};
    case Tiling::slices_xy_z:
      return {x, y, z};
  }
  return {};
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

Status validate(const TextureDesc& desc) noexcept {
  if (find_format(desc.format) == nullptr) return Status::unsupported_format;
  const auto& grid = desc.grid;
  if (grid.x < 1 || grid.y < 1 || grid.z < 1 || grid.x > kMaxGridSide || grid.y > kMaxGridSide ||
      grid.z > kMaxGridSide) {
    return Status::invalid_description;
  }
  const std::uint64_t plane = std::uint64_t{grid.x} * grid.y;
  if (plane > kMaxProbes || plane * grid.z > kMaxProbes) return Status::invalid_description;
  if (desc.core < 1 || desc.core > kMaxCore || desc.border > 1) return Status::invalid_description;
  if (static_cast<std::uint8_t>(desc.tiling) >= kTilingCount) return Status::invalid_description;
  return Status::ok;
}

std::uint32_t probe_count(const TextureDesc& desc) noexcept {
  return desc.grid.x * desc.grid.y * desc.grid.z;
}

std::uint32_t block_side(const TextureDesc& desc) noexcept {
  return std::uint32_t{desc.core} + 2U * desc.border;
}

std::uint32_t texel_bytes(const TextureDesc& desc) noexcept {
  const auto* info = find_format(desc.format);
  return info == nullptr ? 0 : info->texel_bytes;
}

std::size_t core_bytes(const TextureDesc& desc) noexcept {
  return std::size_t{desc.core} * desc.core * texel_bytes(desc);
}

Extent extent(const TextureDesc& desc) noexcept {
  const auto count = tiles(desc);
  const auto side = block_side(desc);
  return {static_cast<std::uint32_t>(count.columns * side),
          static_cast<std::uint32_t>(count.rows * side), static_cast<std::uint32_t>(count.slices)};
}

std::uint64_t texture_bytes(const TextureDesc& desc) noexcept {
  const auto size = extent(desc);
  return std::uint64_t{size.width} * size.height * size.slices * texel_bytes(desc);
}

BlockOrigin block_origin(const TextureDesc& desc, std::uint32_t probe) noexcept {
  const auto& grid = desc.grid;
  const std::uint32_t x = probe % grid.x;
  const std::uint32_t y = probe / grid.x % grid.y;
  const std::uint32_t z = probe / grid.x / grid.y;
  const auto side = block_side(desc);
  switch (desc.tiling) {
    case Tiling::atlas_xy_z:
      return {(x + grid.x * y) * side, z * side, 0};
    case Tiling::atlas_xz_y:
      return {(x + grid.x * z) * side, y * side, 0};
    case Tiling::atlas_x_yz:
      return {x * side, (y + grid.y * z) * side, 0};
    case Tiling::slices_xz_y:
      return {x * side, z * side, y};
    case Tiling::slices_xy_z:
      return {x * side, y * side, z};
  }
  return {};
}

}  // namespace gicodec
