#include "support.h"

#include <algorithm>

namespace gicodec::test {

std::size_t guarded_bytes(const TextureDesc& desc) {
  const std::size_t band = 2U * desc.guard_band;
  return (desc.block.x + band) * (desc.block.y + band) * desc.block.z * desc.record.bytes;
}

void clear_absent_records(const TextureDesc& desc, std::span<const std::byte> presence,
                          std::span<std::byte> block) {
  const std::size_t size = desc.record.bytes;
  for (std::size_t r = 0; r < record_count(desc.block); ++r) {
    bool exists = true;
    if (desc.presence == Presence::count) {
      const std::size_t count = std::to_integer<std::size_t>(presence[0]) +
                                256 * std::to_integer<std::size_t>(presence[1]);
      exists = r < count;
    } else if (desc.presence == Presence::mask) {
      exists = (std::to_integer<unsigned>(presence[r / 8]) >> r % 8 & 1) != 0;
    } else if (desc.presence == Presence::brick) {
      const std::size_t voxel = r / kVoxelDirections;
      exists = (std::to_integer<unsigned>(presence[8 + voxel / 8]) >> voxel % 8 & 1) != 0;
    }
    if (!exists) std::fill_n(block.data() + r * size, size, std::byte{0});
  }
}

ExpectedMirror::ExpectedMirror(const TextureDesc& desc)
    : desc_(desc),
      block_bytes_(guarded_bytes(desc)),
      blocks_(block_count(desc) * block_bytes_),
      received_(block_count(desc)) {}

void ExpectedMirror::apply(const Texture& texture, bool keyframe,
                           std::span<const std::uint32_t> blocks,
                           std::span<const std::byte> presence) {
  if (keyframe) {
    std::fill(blocks_.begin(), blocks_.end(), std::byte{0});
    std::fill(received_.begin(), received_.end(), std::uint8_t{0});
  }
  const std::size_t bytes = presence_bytes(desc_);
  for (const auto block : blocks) {
    auto now = texture.block(block);
    if (!presence.empty()) {
      clear_absent_records(desc_, presence.subspan(block * bytes, bytes), now);
    }
    std::copy(now.begin(), now.end(),
              blocks_.begin() + static_cast<std::ptrdiff_t>(block * block_bytes_));
    received_[block] = 1;
  }
}

std::span<const std::byte> ExpectedMirror::block(std::uint32_t block) const {
  return std::span(blocks_).subspan(block * block_bytes_, block_bytes_);
}

Bytes ExpectedMirror::records() const {
  const std::size_t band = desc_.guard_band, record = desc_.record.bytes;
  const std::size_t side = desc_.block.x + 2 * band;
  Bytes out;
  for (std::uint32_t i = 0; i < block_count(desc_); ++i) {
    for (std::size_t row = 0; row < std::size_t{desc_.block.y} * desc_.block.z; ++row) {
      const auto from =
          block(i).subspan(((row + band) * side + band) * record, desc_.block.x * record);
      out.insert(out.end(), from.begin(), from.end());
    }
  }
  return out;
}

}  // namespace gicodec::test
