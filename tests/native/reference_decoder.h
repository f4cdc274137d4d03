// A decoder written from docs/native.md alone, one texel and one lane at a time. It shares nothing
// with the library but the table data, which is part of that page.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::reference {

/// The texels of `probes`, or nothing for a payload that breaks the format. `mirror` holds the core
/// texels of every probe and is empty for a keyframe.
[[nodiscard]] std::optional<std::vector<std::byte>> decode(const TextureDesc& desc,
                                                           std::span<const std::uint32_t> probes,
                                                           std::span<const std::byte> mirror,
                                                           std::span<const std::byte> payload);

}  // namespace gicodec::reference
