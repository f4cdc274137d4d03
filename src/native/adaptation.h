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
inline constexpr unsigned kMaxMembers = 16;  ///< distributions that a chunk brings along

using Frequencies = std::array<std::uint16_t, kTokens>;  ///< 1..4095 each, 4096 in all

/// Departures from a table set, ascending by context (docs/native.md, "Overrides").
struct Overrides {
  struct Token {
    std::uint16_t context;
    std::uint8_t distribution;
  };
  struct Hit {
    std::uint8_t context;
    std::uint16_t end0, end1;
  };
  std::vector<Frequencies> members;  ///< of the family, from kDistributions on
  std::vector<Token> tokens;
  std::vector<Hit> hits;
  [[nodiscard]] bool empty() const { return tokens.empty() && hits.empty(); }
  void clear() {
    members.clear();
    tokens.clear();
    hits.clear();
  }
};

/// A set with overrides applied. The result refers to this object.
class AdaptedTables {
 public:
  const Tables& apply(const Tables& set, const Overrides& overrides);

 private:
  Tables tables_{};
  std::vector<std::uint8_t> map_;
  std::vector<Distribution> family_;  // and the chunk's members
  alignas(64) std::uint16_t hits_[2 * kHitContexts];
};

/// Counts of coded symbols by context.
class Histogram {
 public:
  void clear();
  void add(std::span<const Step> steps);
  /// The set that codes the counts in least space, and how much that is.
  struct Fit {
    unsigned set;
    std::uint64_t bytes;
  };
  [[nodiscard]] Fit best_set(bool update) const;
  /// What departures from `set` pay. The counts stand for `scale` times as many symbols; `effort`
  /// is the number of members to try.
  void choose(const Tables& set, std::uint32_t scale, unsigned effort, Overrides& overrides) const;

 private:
  void choose_hits(const Tables& set, std::uint32_t scale, Overrides& overrides) const;

  using Counts = std::array<std::int16_t, kTokens>;
  std::vector<std::uint16_t> slot_;  // of a context in counts_
  std::vector<std::uint16_t> contexts_;
  std::vector<Counts> counts_;
  std::vector<std::uint32_t> seen_;  // sum of counts
  std::array<std::array<std::uint32_t, 3>, kHitContexts> hits_{};
};

}  // namespace gicodec::native
