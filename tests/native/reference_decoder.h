// A decoder written from docs/native.md alone, one record and one lane at a time. It shares nothing
// with the library but the file of tables, which is part of that page.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::reference {

/// The records of `blocks`, or nothing for a payload that breaks the format. `mirror` holds the
/// records of every block and `received` says which of them were received; both are empty for a
/// keyframe. `presence` says which records of `blocks` exist, where not all do. `intra`: it is an
/// intra update. `held_presence`: of bricks, with what every block of the mirror was received.
[[nodiscard]] std::optional<std::vector<std::byte>> decode(
    const TextureDesc& desc, std::span<const std::uint32_t> blocks,
    std::span<const std::byte> mirror, std::span<const std::uint8_t> received,
    std::span<const std::byte> payload, std::span<const std::byte> presence = {},
    bool intra = false, std::span<const std::byte> held_presence = {});

}  // namespace gicodec::reference
