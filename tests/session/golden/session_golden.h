// What the golden sessions hold: textures by formulas, a volume that scrolls, a client that
// watches.
#pragma once

#include "support.h"

#include <gicodec/client.h>
#include <gicodec/host.h>

#include <string>
#include <vector>

namespace gicodec::golden {

inline constexpr int kUpdates = 6;
inline constexpr Grid kGrid{4, 2, 3};
inline constexpr std::uint32_t kProbes = 24;

inline std::vector<TextureDesc> session_textures() {
  return {{Format::A2B10G10R10_UNORM_PACK32, kGrid, 4, 1, Tiling::atlas_xy_z},
          {Format::R16G16_SFLOAT, kGrid, 3, 1, Tiling::slices_xz_y}};
}

inline Scroll session_scroll(int update) { return update < 3 ? Scroll{0, 0, 0} : Scroll{1, 0, -1}; }

/// Probe p changes in every (p mod 3 + 1)th update; those that entered with the scroll differ.
inline void paint_session(test::Texture& texture, int update) {
  const auto& desc = texture.desc();
  VolumeGeometry volume{kGrid};
  volume.scroll = session_scroll(update);
  for (std::uint32_t probe = 0; probe < kProbes; ++probe) {
    const Position place = probe_position(volume, probe);
    const auto at = static_cast<std::uint32_t>(place[0] * 5 + place[1] * 11 + place[2] * 17 + 99);
    const auto age = static_cast<std::uint32_t>(update) / (probe % 3 + 1);
    for (std::uint32_t y = 0; y < desc.core; ++y) {
      for (std::uint32_t x = 0; x < desc.core; ++x) {
        const auto texel = texture.texel(probe, x + 1, y + 1);
        for (std::uint32_t byte = 0; byte < 4; ++byte) {
          texel[byte] = static_cast<std::byte>(at + age * 3 + x + y * 2 + byte * 64);
        }
      }
    }
    texture.fill_border(probe);
    if (probe == 7) texture.texel(probe, 0, 0)[0] ^= std::byte{0x55};  // A stale guard band.
  }
}

/// A message and who sent it.
struct Recorded {
  bool from_server = false;
  Message message;
};

}  // namespace gicodec::golden
