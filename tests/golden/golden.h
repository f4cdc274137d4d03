// What the golden files hold: textures by fixed formulas, so that no texels need to be stored.
#pragma once

#include "support.h"

namespace gicodec::golden {

inline constexpr std::uint32_t kFrames = 5;
inline constexpr std::uint32_t kIndexProbes = 64;

/// The textures of sequence_BACKEND.gic: one of each format.
inline std::vector<TextureEntry> sequence_textures() {
  std::vector<TextureEntry> textures;
  for (std::size_t i = 0; i < formats().size(); ++i) {
    const TextureDesc desc{formats()[i].format,
                           {3, 1, 2},
                           static_cast<std::uint16_t>(1 + i % 4),
                           static_cast<std::uint16_t>(i % 3 != 2),
                           static_cast<Tiling>(i % kTilingCount)};
    textures.push_back({std::string(formats()[i].name), desc, {{"place", std::to_string(i)}}});
  }
  return textures;
}

/// A byte of texel (x, y) of a core in a frame. Smooth with some noise; most probes rest.
inline std::byte core_byte(std::uint32_t frame, std::uint32_t probe, std::uint32_t x,
                           std::uint32_t y, std::uint32_t byte) {
  const std::uint32_t updates = (frame + probe) / 3;
  const std::uint32_t noise = (((x * 31 + y) * 37 + probe * 11 + updates) * 2654435761U) >> 29;
  return static_cast<std::byte>(byte * 64 + x * 3 + y * 5 + probe * 7 + updates * 2 + noise);
}

/// The whole texture in a frame. Probe 4 has one stale border texel, from frame 2 on another one.
inline void paint(test::Texture& texture, std::uint32_t frame) {
  const auto& desc = texture.desc();
  for (std::uint32_t probe = 0; probe < probe_count(desc); ++probe) {
    for (std::uint32_t y = 0; y < desc.core; ++y) {
      for (std::uint32_t x = 0; x < desc.core; ++x) {
        const auto texel = texture.texel(probe, x + desc.border, y + desc.border);
        for (std::uint32_t byte = 0; byte < texel.size(); ++byte) {
          texel[byte] = core_byte(frame, probe, x, y, byte);
        }
      }
    }
    texture.fill_border(probe);
    if (desc.border == 1 && probe == 4)
      texture.texel(probe, frame < 2 ? 0 : 1, 0)[0] ^= std::byte{0x55};
  }
}

/// The texture of the packets index_MODE.packet: single texels, value 257 · (probe + 1) if listed.
inline TextureDesc index_desc() {
  return {Format::R16_SFLOAT, {8, 4, 2}, 1, 0, Tiling::atlas_xy_z};
}
inline std::vector<std::uint32_t> index_probes(std::string_view mode) {
  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < kIndexProbes; ++probe) {
    const bool listed = mode == "all"      ? true
                        : mode == "bitmap" ? probe * 2654435761U >> 31 != 0
                        : mode == "gaps"   ? probe % 17 == 5
                        : mode == "runs"   ? probe >= 3 && probe < 60 && probe != 31
                                           : false;
    if (listed) probes.push_back(probe);
  }
  return probes;
}
inline constexpr std::string_view kIndexModes[] = {"all", "bitmap", "gaps", "runs", "empty"};

}  // namespace gicodec::golden
