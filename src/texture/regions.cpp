// Regions: boxes of blocks.
#include <gicodec/volume.h>

#include <algorithm>

namespace gicodec {

Grid RegionGrid::place_of(std::uint32_t region) const noexcept {
  return {region % count_.x, region / count_.x % count_.y, region / (count_.x * count_.y)};
}

Grid RegionGrid::first_of(std::uint32_t region) const noexcept {
  const Grid place = place_of(region);
  return {place.x * size_.x, place.y * size_.y, place.z * size_.z};
}

Grid RegionGrid::grid_of(std::uint32_t region) const noexcept {
  const Grid first = first_of(region);
  return {std::min(size_.x, grid_.x - first.x), std::min(size_.y, grid_.y - first.y),
          std::min(size_.z, grid_.z - first.z)};
}

std::uint32_t RegionGrid::region_of(std::uint32_t block) const noexcept {
  const std::uint32_t x = block % grid_.x, y = block / grid_.x % grid_.y,
                      z = block / (grid_.x * grid_.y);
  return x / size_.x + count_.x * (y / size_.y + count_.y * (z / size_.z));
}

std::uint32_t RegionGrid::block_of(std::uint32_t region, std::uint32_t number) const noexcept {
  const Grid first = first_of(region), size = grid_of(region);
  const std::uint32_t x = first.x + number % size.x, y = first.y + number / size.x % size.y,
                      z = first.z + number / (size.x * size.y);
  return x + grid_.x * (y + grid_.y * z);
}

std::uint32_t RegionGrid::number_of(std::uint32_t block) const noexcept {
  const std::uint32_t region = region_of(block);
  const Grid first = first_of(region), size = grid_of(region);
  const std::uint32_t x = block % grid_.x - first.x, y = block / grid_.x % grid_.y - first.y,
                      z = block / (grid_.x * grid_.y) - first.z;
  return x + size.x * (y + size.y * z);
}

std::vector<std::uint32_t> RegionGrid::blocks_of(std::uint32_t region) const {
  const Grid first = first_of(region), size = grid_of(region);
  std::vector<std::uint32_t> blocks;
  blocks.reserve(std::size_t{size.x} * size.y * size.z);
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t y = 0; y < size.y; ++y) {
      for (std::uint32_t x = 0; x < size.x; ++x) {
        blocks.push_back(first.x + x + grid_.x * (first.y + y + grid_.y * (first.z + z)));
      }
    }
  }
  return blocks;
}

RegionGrid regions_of(const TextureDesc& desc, const Grid& size) noexcept {
  if (desc.space == Space::grid) return {desc.grid, size};
  const std::uint64_t plane = std::min<std::uint64_t>(std::uint64_t{size.x} * size.y, kMaxBlocks);
  return {desc.grid,
          {static_cast<std::uint32_t>(std::min<std::uint64_t>(plane * size.z, kMaxBlocks)), 1, 1}};
}

TextureDesc region_texture(const TextureDesc& desc, const Grid& size,
                           std::uint32_t region) noexcept {
  const RegionGrid regions = regions_of(desc, size);
  TextureDesc part = desc;
  part.grid = regions.grid_of(region);
  part.layout = Tiling::atlas_xy_z;
  if (desc.records.x == 0) return part;
  const Grid first = regions.first_of(region);
  const auto left = [](std::uint32_t records, std::uint32_t begin, std::uint32_t blocks,
                       std::uint32_t side) {
    return std::min(blocks * side, records - begin * side);
  };
  part.records = {left(desc.records.x, first.x, part.grid.x, desc.block.x),
                  left(desc.records.y, first.y, part.grid.y, desc.block.y),
                  left(desc.records.z, first.z, part.grid.z, desc.block.z)};
  return part;
}

}  // namespace gicodec
