// Ordinals of a channel ↔ amounts of light, in integers (docs/native/continuous.md, "Light").
#pragma once

#include "native/raster/channels.h"
#include "quantise/component_code.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace gicodec::native {

inline constexpr unsigned kFraction = 4;  ///< bits of predictions below an ordinal
inline constexpr std::int64_t kHalfUnit = 1 << (kFraction - 1);

/// The nearest ordinal of a prediction.
constexpr std::int64_t rounded(std::int64_t prediction) {
  return (prediction + kHalfUnit) >> kFraction;
}

/// In units of the least that a float of the channel's kind can be. Precondition: Scale::none not.
inline std::int64_t light_of(const Channel& channel, std::uint32_t ordinal) {
  if (channel.scale == Scale::linear) return ordinal;
  const unsigned mantissa = mantissa_bits(channel.component);
  const std::uint32_t sign = channel.scale == Scale::half ? sign_bit(channel.component) : 0;
  const bool negative = sign != 0 && (ordinal & sign) == 0;
  const std::uint32_t code = negative ? ~ordinal & (sign - 1) : ordinal & (sign - 1U);
  const std::uint32_t exponent = code >> mantissa;
  const std::int64_t digits = code & ((1U << mantissa) - 1);
  const std::int64_t light =
      exponent == 0 ? digits : (digits + (std::int64_t{1} << mantissa)) << (exponent - 1);
  return negative ? -light : light;
}

/// The ordinal that light has, in sixteenths. `light` is not negative.
inline std::int64_t ordinal_of_light(const Channel& channel, std::int64_t light) {
  constexpr std::int64_t kMostLinear = 1 << 20;
  if (channel.scale == Scale::linear) return std::min(light, kMostLinear) << kFraction;
  const int mantissa = static_cast<int>(mantissa_bits(channel.component));
  const int shift = std::max(
      0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(light))) - 1 - mantissa);
  const std::int64_t sign = channel.scale == Scale::half ? sign_bit(channel.component) : 0;
  return (((std::int64_t{shift} << mantissa) + sign) << kFraction) +
         ((light << kFraction) >> shift);
}

}  // namespace gicodec::native
