// Counts of coded values by context.
#pragma once

#include "native/planes/kernels.h"
#include "native/planes/tables.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gicodec::train {

/// What is clustered on its own: the native codec's roles, but modes by what has them, and repeats.
enum Subject : unsigned {
  kResiduals = 0,              ///< one by role
  kModes = native::kModeRole,  ///< of keyframes and updates, planes, then pairs
  kRepeatTables = kModes + 4,  ///< of keyframes and updates
  kSubjects = kRepeatTables + 2,
};
Subject subject_of(bool pairs, bool update, unsigned place);

using Counts = std::array<std::uint32_t, native::kBins>;  ///< by bin; of repeats by symbol

/// A subject's counts in one frame of one texture.
struct Histogram {
  struct Cell {
    std::uint16_t context;
    Counts counts;
  };
  bool wide;                ///< which thresholds its magnitudes have
  std::vector<Cell> cells;  ///< contexts that occur
};

/// One frame of one texture, coded as a keyframe or as an update.
class Counter {
 public:
  Counter(bool pairs, bool update) : pairs_(pairs), update_(update) {}
  void add(const native::Step* begin, const native::Step* end);
  /// Appends what was counted to its subjects.
  void finish(bool wide, std::array<std::vector<Histogram>, kSubjects>& out) const;

 private:
  bool pairs_, update_;
  std::vector<Counts> counts_ =
      std::vector<Counts>(std::size_t{native::kPlaces} * native::kContexts);
};

}  // namespace gicodec::train
