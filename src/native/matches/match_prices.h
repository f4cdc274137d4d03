// What match chunks take, about: by what encoders choose.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

/// Prices are whole numbers, the same on every machine: of 1/256 bits.
using Price = std::int64_t;
inline constexpr Price kBit = 256;

/// Of what a tree learns about a symbol.
inline constexpr Price kPriceOfSymbol = 6 * kBit;

/// Logarithm to base 2, by straight lines between powers of two.
constexpr Price log2_of(std::uint64_t n) {
  const auto whole = static_cast<unsigned>(std::bit_width(n | 1)) - 1;
  const std::uint64_t rest = whole > 8 ? n >> (whole - 8) : n << (8 - whole);
  return whole * kBit + static_cast<Price>(rest) - kBit;
}

using ByteCounts = std::array<std::uint32_t, 256>;

/// Of so many bytes, by how often each occurs.
constexpr Price entropy(const ByteCounts& counts, std::uint64_t all) {
  Price price = 0;
  for (const auto n : counts) {
    if (n != 0) price += kPriceOfSymbol + n * (log2_of(all) - log2_of(n));
  }
  return price;
}

/// What follows literals: a match at one of the last distances, zeros, a match at a new distance.
inline constexpr unsigned kWays = 6, kNewDistance = 5;

/// What another way must save to be taken for the same bytes: what alternates costs bits.
inline constexpr Price kHabit = 2 * kBit;

/// Of matches, by how often each way was taken of late.
class MatchPrices {
 public:
  MatchPrices() { update(); }
  [[nodiscard]] Price of(unsigned way) const { return price_[way]; }
  /// Of a new distance.
  [[nodiscard]] Price of(std::uint64_t distance, std::uint64_t unit) const {
    const Price odd = distance % unit != 0 ? 3 * kBit : 0;
    return price_[kNewDistance] + odd + log2_of(distance / unit + 1);
  }
  void count(std::size_t literals, unsigned way) {
    all_ += literals + 1;
    ++taken_[way];
    if (all_ > kForget) {
      all_ /= 2;
      for (auto& taken : taken_) taken = (taken + 1) / 2;
    }
    update();
  }

 private:
  static constexpr Price kLength = 4 * kBit, kDistance = 4 * kBit;
  static constexpr std::uint64_t kForget = 4096;

  void update() {
    for (unsigned way = 0; way < kWays; ++way) {
      price_[way] = kLength + log2_of(all_) - log2_of(taken_[way]);
    }
    price_[kNewDistance] += kDistance;
  }

  std::uint64_t all_ = 64;  ///< literals and matches
  std::array<std::uint64_t, kWays> taken_{1, 1, 1, 1, 1, 1};
  std::array<Price, kWays> price_{};
};

/// What matches take together, about.
class MatchCounts {
 public:
  void count(std::size_t literals, unsigned way, std::size_t length, std::uint64_t distance,
             std::uint64_t unit) {
    ++all_;
    ++runs_[class_of(literals)];
    ++ways_[way * std::size_t{32} + class_of(length)];
    extra_ += rest_of(literals) + rest_of(length);
    if (way == kNewDistance) extra_ += log2_of(distance / unit + 1);
  }
  [[nodiscard]] Price price() const {
    return all_ == 0 ? 0 : extra_ + entropy(runs_, all_) + entropy(ways_, all_);
  }

 private:
  /// Small numbers each, others by their width.
  static unsigned class_of(std::size_t n) {
    return n < 16 ? static_cast<unsigned>(n)
                  : std::min(11 + static_cast<unsigned>(std::bit_width(n)), 31U);
  }
  static Price rest_of(std::size_t n) {
    return n < 16 ? 0 : (static_cast<Price>(std::bit_width(n)) - 1) * kBit;
  }

  std::uint64_t all_ = 0;
  Price extra_ = 0;
  ByteCounts runs_{}, ways_{};
};

}  // namespace gicodec::native
