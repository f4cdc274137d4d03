// Where a block lies in a file's texels, which are tightly packed, slice after slice.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gicodec::tools {

/// The records of a block in memory, guard band included.
struct BlockPlace {
  std::uint64_t x = 0, y = 0;  ///< of the first record, in the image of stacked slices
  std::size_t offset = 0;      ///< of the first record's first byte
  std::size_t row_bytes = 0, row_pitch = 0, slice_pitch = 0;
  std::uint32_t width = 0, rows = 0, slices = 0;

  [[nodiscard]] std::size_t row(std::uint32_t y_in, std::uint32_t slice) const noexcept {
    return offset + y_in * row_pitch + slice * slice_pitch;
  }
};
/// `size`: extent(desc). Precondition: block < block_count(desc).
[[nodiscard]] BlockPlace block_place(const TextureDesc& desc, const Extent& size,
                                     std::uint32_t block) noexcept;

/// Calls visit(offset, bytes) for each row of a block until it answers true; returns that.
template <typename Visit>
bool any_row(const TextureDesc& desc, std::uint32_t block, const Visit& visit) {
  const BlockPlace place = block_place(desc, extent(desc), block);
  for (std::uint32_t slice = 0; slice < place.slices; ++slice) {
    for (std::uint32_t y = 0; y < place.rows; ++y) {
      if (visit(place.row(y, slice), place.row_bytes)) return true;
    }
  }
  return false;
}

/// Copies a block to one of the same size in another texture.
void copy_block(const BlockPlace& from, std::span<const std::byte> source, const BlockPlace& to,
                std::span<std::byte> target) noexcept;

/// The index of the first record in memory that is not zero and belongs to no block, but to padding
/// or to slots beyond the pool. Throws std::bad_alloc.
[[nodiscard]] std::optional<std::uint64_t> record_in_no_block(const TextureDesc& desc,
                                                              std::span<const std::byte> texels);

}  // namespace gicodec::tools
