// The distance of two blocks.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <span>

namespace gicodec {

/// True if `held` is off by more than `threshold` from what is given, see error_bound.h. With a
/// threshold of 0, true if any bit differs.
[[nodiscard]] bool differs_by_more(const TextureDesc& desc, std::span<const std::byte> given,
                                   std::span<const std::byte> held, float threshold) noexcept;

/// Share of the words of 8, 4, 2 or 1 bytes that records are made of which are not the same, 0
/// to 1.
[[nodiscard]] float changed_share(const TextureDesc& desc, std::span<const std::byte> a,
                                  std::span<const std::byte> b) noexcept;

}  // namespace gicodec
