// Fitting the static tables to a chunk: counts of its symbols, the sets that fit them, and
// overrides of single distributions and contexts.
#pragma once

#include "base/memory.h"
#include "native/planes/kernels.h"

#include <array>
#include <cstdint>
#include <span>

namespace gicodec::native {

/// Differences from the set of one place, ascending (docs/native.md, "Overrides").
struct Overrides {
  struct Replaced {
    std::uint8_t number;
    Distribution distribution;
  };
  struct Moved {
    std::uint8_t context, distribution;
  };
  Vector<Replaced> distributions;
  Vector<Moved> contexts;
  [[nodiscard]] bool empty() const { return distributions.empty() && contexts.empty(); }
  void clear() {
    distributions.clear();
    contexts.clear();
  }
};

/// Repeat tables that a chunk carries.
struct OwnRepeats {
  unsigned distributions = 0;  ///< 0: none
  std::uint16_t end[kDistributions][2];
  std::uint8_t map[kRepeatContexts];
};

/// The tables of a chunk, by place.
struct TableChoice {
  std::uint8_t set[kPlaces] = {};
  std::array<Overrides, 3> overrides;
  OwnRepeats repeats;
  [[nodiscard]] bool overridden() const {
    return !overrides[0].empty() || !overrides[1].empty() || !overrides[2].empty();
  }
  void clear();
};

/// Sets with overrides applied. The result refers to this object.
class AdaptedTables {
 public:
  const Tables& apply(bool pairs, bool update, const TableChoice& choice);

 private:
  Tables tables_{};
  Vector<RoleTables> role_;  // of residual places
  RepeatTables repeats_;
};

/// Counts of coded symbols by place and context.
class Histogram {
 public:
  void clear();
  void add(std::span<const Step> steps);
  /// Chooses the sets that code the counts in least space; returns how many bytes that is.
  std::uint64_t choose_sets(bool pairs, bool update, TableChoice& choice) const;
  /// Chooses overrides that pay. The counts stand for `scale` times as many symbols.
  void choose_overrides(bool pairs, bool update, std::uint32_t scale, TableChoice& choice) const;
  /// Repeat tables of the counts, whether they pay or not.
  void fit_repeats(bool update, std::uint32_t scale, OwnRepeats& own) const;

 private:
  struct Counts {
    std::array<std::int16_t, kBins> of{};
  };
  /// What was seen in one place, context by context.
  struct Place {
    std::array<std::uint16_t, kContexts> slot;
    Vector<std::uint8_t> contexts;
    Vector<Counts> counts;
    Vector<std::uint16_t> seen;  // sums of counts
  };
  using RepeatCounts = std::array<std::uint32_t, 3>;
  static std::uint32_t cost(const Counts& counts, const std::int16_t* price);
  static std::uint64_t cost(const RepeatCounts& n, std::uint32_t end0, std::uint32_t end1);
  [[nodiscard]] std::uint64_t cost_of(const Place& place, const RoleTables& tables) const;
  static void override_place(const Place& place, unsigned role, unsigned set, std::uint32_t scale,
                             Overrides& overrides);
  void override_repeats(const RepeatTables& set, std::uint32_t scale, OwnRepeats& own) const;
  [[nodiscard]] std::uint64_t cost_of(const RepeatTables& tables) const;

  std::array<Place, kPlaces> places_;
  std::array<RepeatCounts, kRepeatContexts> repeats_{};
};

}  // namespace gicodec::native
