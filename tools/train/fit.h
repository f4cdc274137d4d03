// The reduction of counts to the native codec's tables.
#pragma once

#include "train/histograms.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gicodec::train {

struct RepeatEnds {
  std::uint16_t end0, end1;
};

/// A few distributions, and the one of each context.
template <typename Distribution>
struct DistributionTables {
  std::array<Distribution, native::kDistributions> distribution;
  std::array<std::uint8_t, native::kContexts> map;
};

struct Model {
  DistributionTables<native::Distribution> role[native::kRoles][native::kSets];
  DistributionTables<RepeatEnds> repeats[2][native::kSets];
};

/// Clusters each subject's histograms to sets and each set's contexts to distributions. Prints on
/// standard error what all of that takes.
void fit(const std::array<std::vector<Histogram>, kSubjects>& histograms, unsigned threads,
         Model& model);

}  // namespace gicodec::train
