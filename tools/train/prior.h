// Distributions of contexts that were seen little or never.
#pragma once

#include "train/histograms.h"

#include <array>
#include <vector>

namespace gicodec::train {

using Weights = std::array<double, native::kBins>;  ///< by bin; of repeats by symbol

/// Counts of several histograms of one subject.
struct Pool {
  std::vector<Weights> counts = std::vector<Weights>(native::kContexts);
  double narrow = 0, wide = 0;  ///< counts of histograms of either kind

  void add(const Histogram& h, double weight);
  void add(const Pool& other);
};

[[nodiscard]] double sum(const Weights& weights);

/// Distributions of all contexts: each leans on those like it, these on the context's own counts.
[[nodiscard]] std::vector<Weights> smooth(Subject subject, const Pool& pool);

}  // namespace gicodec::train
