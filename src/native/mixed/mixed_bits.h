// Adaptive models of single bits: counters by context, mixed in the logistic domain
// (docs/native.md, "Mixed bits"). Integers only: the same on every machine.
#pragma once

#include "base/memory.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace gicodec::native {

inline constexpr int kMaxStretch = 3071;  ///< 12 in units of 1/256

/// 65536 / (1 + e^(−i/2)), i = −24..24, rounded, of 1 to 65535.
inline constexpr std::array<std::uint16_t, 49> kSquash = {
    1,     1,     1,     2,     3,     5,     8,     13,    22,    36,    60,    98,    162,
    267,   439,   720,   1179,  1921,  3108,  4971,  7812,  11955, 17625, 24743, 32768, 40793,
    47911, 53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476,
    65500, 65514, 65523, 65528, 65531, 65533, 65534, 65535, 65535, 65535};

/// The probability, of 65536, whose stretch is `x`, of −kMaxStretch to kMaxStretch.
constexpr std::uint32_t squash(int x) {
  const auto at = static_cast<unsigned>(x + 3072);
  const std::uint32_t low = kSquash[at >> 7], high = kSquash[(at >> 7) + 1];
  return (low * (128 - (at & 127)) + high * (at & 127) + 64) >> 7;
}
/// The least x with squash(x) ≥ 16·i + 8, i the highest 12 bits of a probability; kMaxStretch if
/// there is none.
inline constexpr auto kStretch = [] {
  std::array<std::int16_t, 4096> table{};
  int x = -kMaxStretch;
  for (unsigned i = 0; i < table.size(); ++i) {
    while (x < kMaxStretch && squash(x) < 16 * i + 8) ++x;
    table[i] = static_cast<std::int16_t>(x);
  }
  return table;
}();

/// The probability of a 1, in the upper 22 bits, and the number of uses, in the others.
using Counter = std::uint32_t;
inline constexpr Counter kNewCounter = 1U << 31;
inline constexpr unsigned kMaxUses = 127;

inline constexpr auto kCounterRate = [] {
  std::array<std::uint16_t, kMaxUses + 1> table{};
  for (unsigned n = 0; n <= kMaxUses; ++n) {
    table[n] = static_cast<std::uint16_t>(131072 / (2 * n + 3));
  }
  return table;
}();

inline void count(Counter& counter, bool bit) {
  const unsigned seen = counter & 1023;
  const auto p = static_cast<std::int32_t>(counter >> 10);
  const std::int32_t to = bit ? (1 << 22) - 1 : 0;
  const auto step = static_cast<std::int32_t>(std::int64_t{to - p} * kCounterRate[seen] >> 16);
  counter = static_cast<std::uint32_t>(p + step) << 10 | (seen < kMaxUses ? seen + 1 : seen);
}

/// Weights of a mixture of N contexts, of 65536.
template <std::size_t N>
struct Mixer {
  std::array<std::int32_t, N> weight;
  constexpr Mixer() : weight{} { weight.fill(65536 * 5 / (4 * static_cast<int>(N))); }
};
inline constexpr std::int32_t kMaxWeight = 1 << 19;
inline constexpr int kMixerRate = 18;                 ///< of 2^20
inline constexpr std::uint32_t kMinProbability = 24;  ///< of 65536, what no bit is less likely than

/// Of 65536, by a sum of weighted stretches.
inline std::uint32_t mixed_probability(std::int64_t sum) {
  return squash(static_cast<int>(std::clamp<std::int64_t>(sum, -kMaxStretch, kMaxStretch)));
}

/// Codes a bit by the mixed probability of its counters, and updates them. `probability`: that of
/// a 1, of 65536.
template <std::size_t N, typename Coder>
bool code_bit(Coder& coder, const std::array<Counter*, N>& context, Mixer<N>& mixer, bool bit,
              std::uint32_t& probability) {
  std::array<std::int32_t, N> s;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < N; ++i) {
    s[i] = kStretch[*context[i] >> 20];
    sum += std::int64_t{s[i]} * mixer.weight[i];
  }
  probability = mixed_probability(sum >> 16);
  bit = coder.bit(std::clamp(probability, kMinProbability, 65536 - kMinProbability), bit);
  const std::int32_t error = (bit ? 65536 : 0) - static_cast<std::int32_t>(probability);
  for (std::size_t i = 0; i < N; ++i) {
    const std::int64_t step = (std::int64_t{s[i]} * error * kMixerRate + (1 << 19)) >> 20;
    mixer.weight[i] =
        std::clamp(mixer.weight[i] + static_cast<std::int32_t>(step), -kMaxWeight, kMaxWeight);
    count(*context[i], bit);
  }
  return bit;
}

/// The same with two mixers that were chosen by different contexts. Each learns on its own, and the
/// coder takes what both say on average.
template <std::size_t N, typename Coder>
bool code_bit(Coder& coder, const std::array<Counter*, N>& context, Mixer<N>& one, Mixer<N>& other,
              bool bit) {
  constexpr int kRate = 80;
  std::array<std::int32_t, N> s;
  std::int64_t sum = 0, other_sum = 0;
  for (std::size_t i = 0; i < N; ++i) {
    s[i] = kStretch[*context[i] >> 20];
    sum += std::int64_t{s[i]} * one.weight[i];
    other_sum += std::int64_t{s[i]} * other.weight[i];
  }
  const std::uint32_t both = mixed_probability((sum + other_sum) >> 17);
  bit = coder.bit(std::clamp(both, kMinProbability, 65536 - kMinProbability), bit);
  const std::int32_t to = bit ? 65536 : 0;
  const std::int32_t error = to - static_cast<std::int32_t>(mixed_probability(sum >> 16));
  const std::int32_t other_error =
      to - static_cast<std::int32_t>(mixed_probability(other_sum >> 16));
  const auto learn = [&](std::int32_t& weight, std::int32_t input, std::int32_t by) {
    const std::int64_t step = (std::int64_t{input} * by * kRate + (1 << 19)) >> 20;
    weight = std::clamp(weight + static_cast<std::int32_t>(step), -kMaxWeight, kMaxWeight);
  };
  for (std::size_t i = 0; i < N; ++i) {
    learn(one.weight[i], s[i], error);
    learn(other.weight[i], s[i], other_error);
    count(*context[i], bit);
  }
  return bit;
}

/// Hashes of contexts: a chain of values.
constexpr std::uint32_t hashed(std::uint32_t hash, std::uint32_t value) {
  const std::uint32_t h = (hash + value + 1) * 0x9E3779B1U;
  return h ^ h >> 15;
}
template <typename... More>
constexpr std::uint32_t hashed(std::uint32_t hash, std::uint32_t value, More... more) {
  return hashed(hashed(hash, value), more...);
}

/// What spreads hashes over tables.
inline constexpr std::uint32_t kBucketFactor = 0xC2B2AE35U;

/// Counters by the hash of their context, in buckets of 16.
class CounterTable {
 public:
  static constexpr unsigned kLogarithm = 14, kBucket = 16;
  /// A bucket is initialised at its first use: short chunks use few.
  void reset() {
    // Either allocation may fail: the one made last shows whether both are there.
    if (made_.empty() || ++generation_ == 0) {
      counters_.resize(std::size_t{kBucket} << kLogarithm);
      made_.assign(std::size_t{1} << kLogarithm, 0);
      generation_ = 1;
    }
  }
  [[nodiscard]] Counter* operator[](std::uint32_t hash) {
    const std::size_t bucket = hash * kBucketFactor >> (32 - kLogarithm);
    Counter* const counters = counters_.data() + bucket * kBucket;
    if (made_[bucket] != generation_) {
      made_[bucket] = generation_;
      std::fill_n(counters, kBucket, kNewCounter);
    }
    return counters;
  }

 private:
  Vector<Counter> counters_;
  Vector<std::uint32_t> made_;  ///< the generation of each bucket
  std::uint32_t generation_ = 0;
};

}  // namespace gicodec::native
