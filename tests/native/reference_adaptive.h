// Adaptive chunks for the reference decoder, from docs/native.md, section 9, and docs/native/
// alone.
#pragma once

#include <gicodec/texture.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::reference {

/// A block of an adaptive chunk: which of its records exist, its mirror block, empty in keyframes,
/// and where it is in the grid.
struct AdaptiveBlock {
  std::vector<bool> exists;
  std::vector<std::byte> previous;
  std::array<std::uint32_t, 3> place{};
  /// Of bricks: their presence, and that which the mirror's have; empty if there are none.
  std::vector<std::byte> presence{}, previous_presence{};
};

/// A brick of the mirror that is not in the update.
struct HeldBrick {
  std::vector<std::byte> presence, records;
};

/// Blocks of the chunk's box that are not in the update but in the mirror, by their places.
using HeldBlocks = std::map<std::array<std::uint32_t, 3>, std::vector<std::byte>>;

/// The blocks' records, or nothing for a stream that breaks the format.
[[nodiscard]] std::optional<std::vector<std::vector<std::byte>>> decode_adaptive(
    const TextureDesc& desc, const std::array<std::uint32_t, 3>& box,
    const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held,
    const std::vector<HeldBrick>& bricks, std::span<const std::byte> stream);

/// The same of a row chunk (docs/native/rows.md), without its first byte.
[[nodiscard]] std::optional<std::vector<std::vector<std::byte>>> decode_rows(
    const TextureDesc& desc, const std::array<std::uint32_t, 3>& box,
    const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held,
    std::span<const std::byte> bytes);

/// The same of a match chunk (docs/native/matches.md), without its first byte.
[[nodiscard]] std::optional<std::vector<std::vector<std::byte>>> decode_matches(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks,
    std::span<const std::byte> stream);

}  // namespace gicodec::reference
