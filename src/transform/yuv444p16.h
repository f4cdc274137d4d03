// A2RGB10 ↔ YUV444P16 (Stengel et al. §3.3, Figure 4 top): R→Y, G→U, B→V without a colour matrix,
// each 10-bit code in a 16-bit word. Alpha is kept beside the planes.
#pragma once

#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gicodec {

/// Position of the 10 bits in their 16-bit word; the other bits are zero.
enum class SampleAlignment : std::uint8_t {
  high,  ///< bits 6-15: hardware encoders (P010 convention)
  low,   ///< bits 0-9: x265's 10-bit input
};

template <typename T>
struct Planes {
  std::span<T> y, u, v;
};

[[nodiscard]] constexpr bool is_a2rgb10(Format format) noexcept {
  return format == Format::A2R10G10B10_UNORM_PACK32 || format == Format::A2B10G10R10_UNORM_PACK32;
}

/// `texels` holds one 4-byte texel per plane sample. Precondition: is_a2rgb10(format).
void to_yuv444p16(Isa isa, Format format, SampleAlignment alignment,
                  std::span<const std::byte> texels, const Planes<std::uint16_t>& planes) noexcept;
/// Writes the texels with alpha 0. False if a sample has a bit outside its 10 (the texels are then
/// unspecified).
[[nodiscard]] bool from_yuv444p16(Isa isa, Format format, SampleAlignment alignment,
                                  const Planes<const std::uint16_t>& planes,
                                  std::span<std::byte> texels) noexcept;

/// The alpha code that all texels share, if they do; 0 for no texels.
[[nodiscard]] std::optional<std::uint8_t> constant_alpha(
    std::span<const std::byte> texels) noexcept;
/// The alpha codes packed four to a byte, first texel lowest; `packed` has ⌈texels/4⌉ bytes.
void pack_alpha(std::span<const std::byte> texels, std::span<std::byte> packed) noexcept;
/// Sets the alpha bits of texels. Precondition: they are zero.
void add_alpha(std::uint8_t alpha, std::span<std::byte> texels) noexcept;
void unpack_alpha(std::span<const std::byte> packed, std::span<std::byte> texels) noexcept;

}  // namespace gicodec
