// Counts of symbols by context, and their reduction to table sets.
#pragma once

#include "native/kernels.h"

#include <array>
#include <cstddef>
#include <vector>

namespace gicodec::train {

inline constexpr unsigned kContexts = native::kRows * native::kRowSize;
using Distribution = std::array<float, native::kTokens>;
using HitDistribution = std::array<float, 3>;

/// Counts of one frame of one texture, keyframe or update.
struct Histogram {
  std::vector<Distribution> tokens{kContexts, Distribution{}};
  std::vector<HitDistribution> hits{native::kHitContexts, HitDistribution{}};

  void add(const native::Step* begin, const native::Step* end);
  void add(const Histogram& other);
};

/// Sources of one kind (texture and keyframe or update) never share contexts with another kind.
struct Kind {
  std::vector<Histogram> sources;
  bool update = false;
};

/// What is committed, before it is rounded.
struct Model {
  std::array<Distribution, native::kDistributions> family{};
  std::array<std::vector<std::uint8_t>, native::kSets> map;  ///< [context]
  /// [set][update][context]
  std::array<std::array<std::vector<HitDistribution>, 2>, native::kSets> hits;
};

/// Clusters each kind's sources into sets, smooths, and fits the family.
[[nodiscard]] Model fit(const std::vector<Kind>& kinds);

/// Frequencies that sum to 4096, each at least 1.
[[nodiscard]] std::array<unsigned, native::kTokens> quantise(const Distribution& p);

}  // namespace gicodec::train
