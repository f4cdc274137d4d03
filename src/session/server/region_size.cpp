#include "session/server/region_size.h"

#include <algorithm>

namespace gicodec {
namespace {

/// A link of 1 Mbps carries an update of so many bytes of probe records in about 0.1 s.
constexpr std::size_t kRegionBytes = 192 << 10;
constexpr std::size_t kMaxSlots = 4096;

/// Bytes of the largest block of a packet, those of a bundled group's textures together.
std::size_t bytes_of_a_block(const VolumeDesc& volume) noexcept {
  std::size_t most = 1;
  for (const TextureGroup& group : volume.groups) {
    std::size_t sum = 0;
    for (const NamedTexture& texture : group.textures) {
      const std::size_t bytes = block_bytes(texture.desc);
      sum += bytes;
      if (!group.bundled) most = std::max(most, bytes);
    }
    if (group.bundled) most = std::max(most, sum);
  }
  return most;
}

}  // namespace

Grid usual_region(const VolumeDesc& volume) noexcept {
  const TextureDesc& first = volume.groups.front().textures.front().desc;
  const std::size_t bytes = bytes_of_a_block(volume);
  if (first.space == Space::pool) {
    return {static_cast<std::uint32_t>(std::clamp(kRegionBytes / bytes, std::size_t{1}, kMaxSlots)),
            1, 1};
  }
  Grid region = first.grid.z > 1 ? Grid{4, 4, 4} : Grid{8, 8, 1};
  while (std::size_t{region.x} * region.y * region.z * bytes > kRegionBytes) {
    std::uint32_t& longest = region.z >= std::max(region.x, region.y) ? region.z
                             : region.y >= region.x                   ? region.y
                                                                      : region.x;
    if (longest == 1) break;
    longest = (longest + 1) / 2;
  }
  return region;
}

Grid whole_region(const VolumeDesc& volume) noexcept {
  Grid region{1, 1, 1};
  for (const TextureGroup& group : volume.groups) {
    const Grid& grid = group.textures.front().desc.grid;
    region = {std::max(region.x, grid.x), std::max(region.y, grid.y), std::max(region.z, grid.z)};
  }
  return region;
}

}  // namespace gicodec
