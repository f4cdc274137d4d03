// Copies a block from one texture to another, or fills it with zeros.
#pragma once

#include <gicodec/texture.h>

#include "texture/view.h"

#include <cstdint>
#include <cstring>

namespace gicodec {

/// Copies a block, guard band included, between textures of the same block size.
inline void copy_block(const TextureDesc& from_desc, const CheckedView<const std::byte>& from,
                       std::uint32_t from_block, const TextureDesc& to_desc,
                       const CheckedView<std::byte>& to, std::uint32_t to_block) noexcept {
  const std::size_t record = to_desc.record.bytes, band = std::size_t{2} * to_desc.guard_band;
  const BlockShape inside = block_inside(to_desc, to_block);
  const std::byte* const first = from.at(block_origin(from_desc, from_block), record);
  std::byte* const place = to.at(block_origin(to_desc, to_block), record);
  for (std::size_t z = 0; z < inside.z; ++z) {
    for (std::size_t y = 0; y < inside.y + band; ++y) {
      std::memcpy(place + z * to.slice_pitch + y * to.row_pitch,
                  first + z * from.slice_pitch + y * from.row_pitch, (inside.x + band) * record);
    }
  }
}

inline void clear_block(const TextureDesc& desc, const CheckedView<std::byte>& to,
                        std::uint32_t block) noexcept {
  const std::size_t record = desc.record.bytes, band = std::size_t{2} * desc.guard_band;
  const BlockShape inside = block_inside(desc, block);
  std::byte* const place = to.at(block_origin(desc, block), record);
  for (std::size_t z = 0; z < inside.z; ++z) {
    for (std::size_t y = 0; y < inside.y + band; ++y) {
      std::memset(place + z * to.slice_pitch + y * to.row_pitch, 0, (inside.x + band) * record);
    }
  }
}

}  // namespace gicodec
