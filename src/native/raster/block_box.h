// The least box of blocks around those that a chunk lists (docs/native/continuous.md, "Raster").
#pragma once

#include <gicodec/backend.h>
#include <gicodec/texture.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

[[nodiscard]] inline Grid place_in_grid(const Grid& grid, std::uint32_t block) noexcept {
  return {block % grid.x, block / grid.x % grid.y, block / grid.x / grid.y};
}

struct BlockBox {
  Grid first, blocks;

  [[nodiscard]] std::size_t count() const { return std::size_t{blocks.x} * blocks.y * blocks.z; }
  /// Of a block its first texel's place in the box.
  [[nodiscard]] Grid texel_of(const TextureDesc& desc, std::uint32_t block) const {
    const Grid place = place_in_grid(desc.grid, block);
    return {(place.x - first.x) * desc.block.x, (place.y - first.y) * desc.block.y,
            (place.z - first.z) * desc.block.z};
  }
  /// Calls body(block, its records) for each that the mirror has.
  template <typename Body>
  void for_each_received(const Grid& grid, const MirrorView& mirror, const Body& body) const {
    for (std::uint32_t z = first.z; z < first.z + blocks.z; ++z) {
      for (std::uint32_t y = first.y; y < first.y + blocks.y; ++y) {
        for (std::uint32_t x = first.x; x < first.x + blocks.x; ++x) {
          const std::uint32_t block = x + grid.x * (y + grid.y * z);
          if (mirror.is_received(block)) body(block, mirror.blocks[block]);
        }
      }
    }
  }
};

/// `positions`: in the list of an update's blocks.
[[nodiscard]] inline BlockBox box_around(const Grid& grid, std::span<const std::uint32_t> blocks,
                                         std::span<const std::uint32_t> positions) {
  Grid first = grid, last{};
  for (const std::uint32_t position : positions) {
    const Grid place = place_in_grid(grid, blocks[position]);
    first = {std::min(first.x, place.x), std::min(first.y, place.y), std::min(first.z, place.z)};
    last = {std::max(last.x, place.x), std::max(last.y, place.y), std::max(last.z, place.z)};
  }
  return {first, {last.x - first.x + 1, last.y - first.y + 1, last.z - first.z + 1}};
}

}  // namespace gicodec::native
