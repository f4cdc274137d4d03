// What the golden sessions hold: textures by formulas, a volume that scrolls, a client that
// watches.
#pragma once

#include "support.h"

#include <gicodec/client.h>
#include <gicodec/probes.h>
#include <gicodec/server.h>

#include <string>
#include <vector>

namespace gicodec::golden {

inline constexpr int kUpdates = 6;
inline constexpr Grid kGrid{4, 2, 3};
inline constexpr std::uint32_t kBlocks = 24;

inline std::vector<TextureDesc> session_textures() {
  return {probe_texture(Format::A2B10G10R10_UNORM_PACK32, kGrid, 4),
          probe_texture(Format::R16G16_SFLOAT, kGrid, 3, 1, Tiling::slices_xz_y)};
}

inline Scroll session_scroll(int update) { return update < 3 ? Scroll{0, 0, 0} : Scroll{1, 0, -1}; }

/// Block p changes in every (p mod 3 + 1)th update; those that entered with the scroll differ.
inline void paint_session(test::Texture& texture, int update) {
  const auto& desc = texture.desc();
  VolumeGeometry volume{kGrid};
  volume.scroll = session_scroll(update);
  for (std::uint32_t block = 0; block < kBlocks; ++block) {
    const Position place = block_position(volume, block);
    const auto at = static_cast<std::uint32_t>(place[0] * 5 + place[1] * 11 + place[2] * 17 + 99);
    const auto age = static_cast<std::uint32_t>(update) / (block % 3 + 1);
    for (std::uint32_t y = 0; y < desc.block.x; ++y) {
      for (std::uint32_t x = 0; x < desc.block.x; ++x) {
        const auto texel = texture.record(block, x + 1, y + 1);
        for (std::uint32_t byte = 0; byte < 4; ++byte) {
          texel[byte] = static_cast<std::byte>(at + age * 3 + x + y * 2 + byte * 64);
        }
      }
    }
    texture.fill_band(block);
    if (block == 7) texture.record(block, 0, 0)[0] ^= std::byte{0x55};  // A stale guard band.
  }
}

/// A message and who sent it.
struct Recorded {
  bool from_server = false;
  Message message;
};

}  // namespace gicodec::golden
