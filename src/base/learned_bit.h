// Bits of the binary coder whose probability follows their past (FORMAT.md, "Index buffer").
#pragma once

#include "base/binary_coder.h"

#include <algorithm>
#include <cstdint>

namespace gicodec {

struct LearnedBit {
  std::uint32_t one = 1U << (kBitScale - 1);  ///< probability of a 1
  std::uint32_t asked = 0;

  template <typename Coder>
  bool code(Coder& coder, bool value) {
    // Bounds probabilities, so that every bit costs bytes and time stays in proportion to them.
    constexpr std::uint32_t kMin = 1U << (kBitScale - 6), kAll = 1U << kBitScale, kMaxAsked = 30;
    const bool bit = coder.bit(std::clamp(one, kMin, kAll - kMin), value);
    const std::uint32_t rate = 2 * kAll / (2 * asked + 3);
    const std::uint32_t off = bit ? kAll - 1 - one : one;
    const auto step = static_cast<std::uint32_t>(std::uint64_t{off} * rate >> kBitScale);
    one = bit ? one + step : one - step;
    asked = std::min(asked + 1, kMaxAsked);
    return bit;
  }
};

}  // namespace gicodec
