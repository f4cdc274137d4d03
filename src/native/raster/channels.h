// The components of a texel as channels: ordinals that are ordered as the values are
// (docs/native/continuous.md, "Channels").
#pragma once

#include <gicodec/record.h>

#include <array>
#include <cstdint>

namespace gicodec::native {

/// How a channel's ordinals measure light.
enum class Scale : std::uint8_t {
  none,    ///< not at all, or in a range that is too wide for integers
  linear,  ///< in proportion
  half,    ///< floats of 16 bits
  ufloat,  ///< floats without a sign, of 10 or 11 bits
};

struct Channel {
  Component component;
  Scale scale = Scale::none;
  bool in_units = false;  ///< a mantissa, in units of the texel's exponent

  [[nodiscard]] unsigned bits() const { return component.bits; }
  [[nodiscard]] std::uint32_t largest() const {
    return static_cast<std::uint32_t>((std::uint64_t{1} << bits()) - 1);
  }
};

/// In the order in which they are coded: an exponent that others share, then the others, but of
/// three or more the second component before the first.
struct Channels {
  std::array<Channel, kMaxComponents> channel;
  unsigned count = 0;
  bool shared = false;  ///< channel 0 is the exponent of those in units
};
[[nodiscard]] Channels channels_of(const Record& record) noexcept;

/// The bits of a component ↔ its ordinal.
[[nodiscard]] constexpr std::uint32_t ordinal_of(const Component& component,
                                                 std::uint32_t bits) noexcept {
  const std::uint32_t sign = 1U << (component.bits - 1U), most = sign - 1 + sign;
  if (component.type == ComponentType::snorm) return bits ^ sign;
  if (component.type != ComponentType::sfloat) return bits;
  return (bits & sign) != 0 ? ~bits & most : bits | sign;
}
[[nodiscard]] constexpr std::uint32_t bits_of(const Component& component,
                                              std::uint32_t ordinal) noexcept {
  const std::uint32_t sign = 1U << (component.bits - 1U), most = sign - 1 + sign;
  if (component.type == ComponentType::snorm) return ordinal ^ sign;
  if (component.type != ComponentType::sfloat) return ordinal;
  return (ordinal & sign) != 0 ? ordinal ^ sign : ~ordinal & most;
}

}  // namespace gicodec::native
