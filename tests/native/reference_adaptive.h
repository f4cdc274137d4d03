// Adaptive chunks for the reference decoder, from docs/native.md, section 9, alone.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::reference {

/// A block of an adaptive chunk: which of its records exist, and its past, empty in keyframes.
struct AdaptiveBlock {
  std::vector<bool> exists;
  std::vector<std::byte> past;
};

/// The blocks' records, or nothing for a stream that breaks the format.
[[nodiscard]] std::optional<std::vector<std::vector<std::byte>>> decode_adaptive(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks,
    std::span<const std::byte> stream);

}  // namespace gicodec::reference
