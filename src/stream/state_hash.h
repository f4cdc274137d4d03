// A hash of a receiver's state, by which both ends check that they agree.
#pragma once

#include "base/checksum.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Sum over all received blocks of XXH3-64 of their records, and of their irregular guard bands,
/// seeded by block index.
class StateHash {
 public:
  void add(std::uint32_t block, std::span<const std::byte> records,
           std::span<const std::byte> stale_band) noexcept {
    value_ += XXH3_64bits_withSeed(records.data(), records.size(), std::uint64_t{block} << 1);
    if (stale_band.empty()) return;
    const std::uint64_t seed = std::uint64_t{block} << 1 | 1;
    value_ += XXH3_64bits_withSeed(stale_band.data(), stale_band.size(), seed);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0;
};

}  // namespace gicodec
