// Texel bytes ↔ YUV444P8 (Stengel et al. §3.3, Figure 4 bottom): the bytes of a row of texels go to
// Y, U, V in turn, so that three RG16F texels become the four samples YUVY UVYU VYUV.
#pragma once

#include "transform/yuv444p16.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Samples per plane for a row of `bytes` texel bytes: ⌈bytes/3⌉, i.e. ⌈4x/3⌉ for x RG16F texels.
[[nodiscard]] constexpr std::size_t yuv444p8_width(std::size_t bytes) noexcept {
  return bytes / 3 + (bytes % 3 != 0 ? 1 : 0);
}

/// One row; each plane has yuv444p8_width(row.size()) samples, padded with zero.
void to_yuv444p8(Isa isa, std::span<const std::byte> row,
                 const Planes<std::uint8_t>& planes) noexcept;
/// False if a padding sample is not zero.
[[nodiscard]] bool from_yuv444p8(Isa isa, const Planes<const std::uint8_t>& planes,
                                 std::span<std::byte> row) noexcept;

}  // namespace gicodec
