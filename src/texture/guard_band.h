// Guard bands: the border of a block is a copy of core texels by the octahedral rule (design: DDGI,
// Majercik et al. 2019). A ring is the border of one block as texels: the top row from left to
// right, then for each core row its left and right texel, then the bottom row.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gicodec {

/// Bytes of a ring; 0 without a guard band.
[[nodiscard]] inline std::size_t ring_bytes(const TextureDesc& desc) noexcept {
  return desc.border == 0 ? 0 : std::size_t{4} * (block_side(desc) - 1) * texel_bytes(desc);
}

/// The ring that the rule gives for a core block. `ring` has ring_bytes(desc).
void ring_by_rule(const TextureDesc& desc, const std::byte* core, std::span<std::byte> ring);

}  // namespace gicodec
