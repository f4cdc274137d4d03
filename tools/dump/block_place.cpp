#include "dump/block_place.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace gicodec::tools {

BlockPlace block_place(const TextureDesc& desc, const Extent& size, std::uint32_t block) noexcept {
  BlockOrigin origin = block_origin(desc, block);
  // In an array of blocks the slices of one block follow those of another.
  if (desc.layout.tiling == Tiling::blocks) {
    origin.slice += origin.block * (size.slices / block_count(desc));
  }
  // Only this tiling has no memory for records beyond the texture.
  const bool clipped = desc.layout.tiling == Tiling::slices_xy_z;
  const BlockShape shape = clipped ? block_inside(desc, block) : desc.block;
  BlockPlace place;
  place.x = origin.x;
  place.y = origin.slice * size.height + origin.y;
  place.width = shape.x + 2U * desc.guard_band;
  place.rows = shape.y + 2U * desc.guard_band;
  place.slices = shape.z;
  place.row_bytes = std::size_t{place.width} * desc.record.bytes;
  place.row_pitch = static_cast<std::size_t>(size.width) * desc.record.bytes;
  place.slice_pitch = static_cast<std::size_t>(size.height) * place.row_pitch;
  place.offset = static_cast<std::size_t>(place.y) * place.row_pitch +
                 static_cast<std::size_t>(place.x) * desc.record.bytes;
  return place;
}

void copy_block(const BlockPlace& from, std::span<const std::byte> source, const BlockPlace& to,
                std::span<std::byte> target) noexcept {
  for (std::uint32_t slice = 0; slice < to.slices; ++slice) {
    for (std::uint32_t y = 0; y < to.rows; ++y) {
      std::memcpy(&target[to.row(y, slice)], &source[from.row(y, slice)], to.row_bytes);
    }
  }
}

std::optional<std::uint64_t> record_in_no_block(const TextureDesc& desc,
                                                std::span<const std::byte> texels) {
  const Extent size = extent(desc);
  std::uint64_t inside = 0;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockPlace place = block_place(desc, size, block);
    inside += std::uint64_t{place.row_bytes} * place.rows * place.slices;
  }
  if (inside == texels.size()) return std::nullopt;
  std::vector<std::byte> rest(texels.begin(), texels.end());
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockPlace place = block_place(desc, size, block);
    for (std::uint32_t slice = 0; slice < place.slices; ++slice) {
      for (std::uint32_t y = 0; y < place.rows; ++y) {
        std::memset(&rest[place.row(y, slice)], 0, place.row_bytes);
      }
    }
  }
  const auto found =
      std::ranges::find_if(rest, [](std::byte byte) { return byte != std::byte{0}; });
  if (found == rest.end()) return std::nullopt;
  return static_cast<std::uint64_t>(found - rest.begin()) / desc.record.bytes;
}

}  // namespace gicodec::tools
