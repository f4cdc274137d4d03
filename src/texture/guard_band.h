// Guard bands: the records around a square block, which copy its core by the octahedral rule (DDGI,
// Majercik et al. 2019). A band holds those of one block: the top row from left to right, then for
// each row of the block its left and right record, then the bottom row.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gicodec {

/// Bytes of a band; 0 without a guard band.
[[nodiscard]] inline std::size_t band_bytes(const TextureDesc& desc) noexcept {
  return desc.guard_band == 0 ? 0 : std::size_t{4} * (desc.block.x + 1U) * desc.record.bytes;
}

/// The band that the rule gives for a block. `band` has band_bytes(desc).
void band_by_rule(const TextureDesc& desc, const std::byte* block, std::span<std::byte> band);

}  // namespace gicodec
