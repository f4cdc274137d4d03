// A number for the state of a receiver, with which both ends compare what they believe it to be.
#pragma once

#include "base/checksum.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Sum over probes of XXH3-64 of their core texels, and of their guard bands where those do not
/// follow the rule, seeded by probe number. Probes that both sides leave out do not matter.
class StateHash {
 public:
  void add(std::uint32_t probe, std::span<const std::byte> core,
           std::span<const std::byte> stale_ring) noexcept {
    value_ += XXH3_64bits_withSeed(core.data(), core.size(), std::uint64_t{probe} << 1);
    if (stale_ring.empty()) return;
    const std::uint64_t seed = std::uint64_t{probe} << 1 | 1;
    value_ += XXH3_64bits_withSeed(stale_ring.data(), stale_ring.size(), seed);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0;
};

}  // namespace gicodec
