// Synthetic probe textures for benchmarks: smooth over the sphere and the grid, a little noise, and
// a second frame in which everything moved a little.
#pragma once

#include <gicodec/probes.h>

#include "texture/blocks.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

namespace gicodec::bench {

inline constexpr Grid kGrid{16, 8, 32};

inline std::uint16_t half_bits(float value) {  // Positive normal values only.
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return static_cast<std::uint16_t>((bits >> 13) - ((127 - 15) << 10));
}

/// Records of every block at a time.
inline std::vector<std::byte> make_records(const TextureDesc& desc, float time) {
  std::vector<std::byte> records(block_count(desc) * block_bytes(desc));
  std::mt19937 random(static_cast<unsigned>(time * 1000));
  std::byte* to = records.data();
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const float place = static_cast<float>(block) * 0.37F + time;
    for (std::uint32_t i = 0; i < record_count(desc.block); ++i, to += 4) {
      const float x = static_cast<float>(i % desc.block.x) / static_cast<float>(desc.block.x);
      const float y = static_cast<float>(i / desc.block.x) / static_cast<float>(desc.block.x);
      const float wave = 0.5F + 0.4F * std::sin(place + 3 * x) * std::cos(place * 0.7F + 2 * y);
      std::uint32_t texel;
      if (desc.record.format == Format::R16G16_SFLOAT) {
        const float distance = 1 + 4 * wave + static_cast<float>(random() % 8) * 0.001F;
        texel = half_bits(distance) | std::uint32_t{half_bits(distance * distance)} << 16;
      } else {
        const auto code =
            static_cast<std::uint32_t>(wave * 1000) + static_cast<std::uint32_t>(random() % 4);
        texel = code << 20 | (code * 3 / 4) << 10 | code / 2 | 3U << 30;
      }
      std::memcpy(to, &texel, sizeof texel);
    }
  }
  return records;
}

inline std::vector<std::uint32_t> all_blocks(const TextureDesc& desc) {
  std::vector<std::uint32_t> blocks(block_count(desc));
  std::iota(blocks.begin(), blocks.end(), 0U);
  return blocks;
}

/// The whole texture with guard bands.
inline std::vector<std::byte> make_texture(const TextureDesc& desc, float time) {
  std::vector<std::byte> texture(static_cast<std::size_t>(texture_bytes(desc)));
  reconstruct(best_isa(), desc, *check_view<std::byte>(desc, {texture}), all_blocks(desc),
              make_records(desc, time));
  return texture;
}

}  // namespace gicodec::bench
