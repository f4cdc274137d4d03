// Fitting the static tables to a chunk: counts of what it holds, the set that suits it, and
// overrides of single contexts.
#pragma once

#include "native/tables.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::native {

inline constexpr unsigned kContexts = kRows * kRowSize;

/// Departures from a table set, ascending by context (docs/native.md, "Overrides").
struct Overrides {
  struct Token { std::uint16_t context; std::uint8_t distribution; };
  struct Hit { std::uint8_t context; std::uint16_t end0, end1; };
  std::vector<Token> tokens;
  std::vector<Hit> hits;
  [[nodiscard]] bool empty() const { return tokens.empty() && hits.empty(); }
  void clear() { tokens.clear(); hits.clear(); }
};

/// A set with overrides applied. The result refers to this object.
class AdaptedTables {
 public:
  const Tables& apply(const Tables& set, const Overrides& overrides);

 private:
  Tables tables_{};
  std::vector<std::uint32_t> map_;
  alignas(64) std::uint16_t hits_[2 * kHitContexts];
};

/// Counts of coded symbols by context.
class Histogram {
 public:
  void clear();
  void add(std::span<const Step> steps);
  /// The set that codes the counts in least space.
  [[nodiscard]] unsigned best_set(bool update) const;
  /// What departures from `set` pay. The counts stand for `scale` times as many symbols.
  void choose(const Tables& set, std::uint32_t scale, Overrides& overrides) const;

 private:
  using Counts = std::array<std::uint32_t, 64>;
  std::vector<std::uint16_t> slot_;  // of a context in counts_
  std::vector<std::uint16_t> contexts_;
  std::vector<Counts> counts_;
  std::array<std::array<std::uint32_t, 3>, kHitContexts> hits_{};
};

}  // namespace gicodec::native
