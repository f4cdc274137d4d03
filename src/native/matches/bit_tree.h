// Bits that are learned, and symbols of them (docs/native/matches.md, "Bits, symbols and numbers").
#pragma once

#include "base/binary_coder.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace gicodec::native {

/// A bit whose probability follows its past.
struct MatchBit {
  static constexpr std::uint32_t kMin = 1U << (kBitScale - 11), kMaxAsked = 254;
  std::uint16_t one = 1U << (kBitScale - 1);
  std::uint8_t asked = 0;

  template <typename Coder>
  bool code(Coder& coder, bool value) {
    constexpr std::uint32_t kAll = 1U << kBitScale;
    const bool bit = coder.bit(std::clamp<std::uint32_t>(one, kMin, kAll - kMin), value);
    const std::uint32_t off = bit ? kAll - 1 - one : one;
    const std::uint32_t step = (2 * off + 2 * asked + 2U) / (2 * asked + 3U);
    one = static_cast<std::uint16_t>(bit ? one + step : one - step);
    if (asked < kMaxAsked) ++asked;
    return bit;
  }
};

/// Symbols of `kBits` bits, the highest first, each by those before it.
template <unsigned kBits>
struct BitTree {
  std::array<MatchBit, 1U << kBits> node;

  template <typename Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value, unsigned bits = kBits) {
    std::uint32_t at = 1;
    for (unsigned left = bits; left-- > 0;) {
      at = at << 1 | (node[at].code(coder, (value >> left & 1) != 0) ? 1U : 0U);
    }
    return at - (1U << bits);
  }
};

}  // namespace gicodec::native
