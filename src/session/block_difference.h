// How far two blocks are apart.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <span>

namespace gicodec {

/// True if some component differs by more than `threshold`: codes of unorm components and shared
/// exponents, |a - b| / max(|a|, |b|) of floats. A NaN equals only its own bits. With a threshold
/// of 0, true if any bit differs.
[[nodiscard]] bool differs_by_more(const TextureDesc& desc, std::span<const std::byte> a,
                                   std::span<const std::byte> b, float threshold) noexcept;

/// Share of texels, or of halves of those with 16 bytes, that are not the same, 0 to 1.
[[nodiscard]] float changed_share(const TextureDesc& desc, std::span<const std::byte> a,
                                  std::span<const std::byte> b) noexcept;

}  // namespace gicodec
