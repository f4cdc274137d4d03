#include "train/prior.h"

#include <cmath>
#include <numeric>

namespace gicodec::train {
namespace {

/// Counts that a lean is worth.
constexpr double kLean = 60;

/// Zigzag values of a two-sided geometric distribution whose scale follows the magnitude.
Weights geometric(const native::Thresholds& thresholds, unsigned magnitude) {
  const double s = magnitude == 0 ? 0.3 : thresholds[magnitude - 1];
  const double theta = std::exp(-1 / (s / 3 + 0.3));
  Weights w{};
  for (unsigned bin = 0; bin <= native::bin_of(0xFFFF); ++bin) {
    w[bin] = std::pow(theta, native::bin_begin(bin)) - std::pow(theta, native::bin_begin(bin + 1));
    w[bin] = w[bin] * 0.999 + 0.001 / native::kBins;
  }
  return w;
}

Weights prior(Subject subject, bool wide, unsigned context) {
  Weights w{};
  if (subject >= kRepeatTables) {
    const unsigned score = context / 5;
    w[0] = static_cast<double>(1 + score);
    w[1] = w[2] = 1;
  } else if (subject >= kModes) {
    std::fill_n(w.begin(), native::kModes, 1.0);
  } else {
    const unsigned magnitude = context % native::kSignStep;
    const auto& thresholds = wide ? native::kWideThresholds : native::kNarrowThresholds;
    // Narrow planes hardly reach the last one but at first texels, which say nothing.
    constexpr unsigned kMedium = 10;
    const bool first = !wide && magnitude == native::kFirstTexel;
    w = geometric(thresholds, first ? kMedium : magnitude);
  }
  const double total = sum(w);
  for (double& p : w) p /= total;
  return w;
}

/// Contexts of one group are alike: all classes, or all votes.
unsigned group_of(Subject subject, unsigned context) {
  if (subject >= kRepeatTables) return context / 5;
  return subject >= kModes ? context : context % native::kClassStep;
}

Weights blend(const Weights& counts, const Weights& with) {
  const double total = sum(counts) + kLean;
  Weights w;
  for (unsigned b = 0; b < native::kBins; ++b) w[b] = (counts[b] + kLean * with[b]) / total;
  return w;
}

}  // namespace

void Pool::add(const Histogram& h, double weight) {
  for (const auto& cell : h.cells) {
    Weights& to = counts[cell.context];
    for (unsigned b = 0; b < native::kBins; ++b) {
      const double n = weight * cell.counts[b];
      to[b] += n;
      (h.wide ? wide : narrow) += n;
    }
  }
}

void Pool::add(const Pool& other) {
  for (unsigned c = 0; c < native::kContexts; ++c) {
    for (unsigned b = 0; b < native::kBins; ++b) counts[c][b] += other.counts[c][b];
  }
  narrow += other.narrow;
  wide += other.wide;
}

double sum(const Weights& weights) { return std::accumulate(weights.begin(), weights.end(), 0.0); }

std::vector<Weights> smooth(Subject subject, const Pool& pool) {
  std::vector<Weights> groups(native::kContexts), result;
  for (unsigned c = 0; c < native::kContexts; ++c) {
    Weights& to = groups[group_of(subject, c)];
    for (unsigned b = 0; b < native::kBins; ++b) to[b] += pool.counts[c][b];
  }
  for (unsigned c = 0; c < native::kContexts; ++c) {
    const Weights lean = prior(subject, pool.wide > pool.narrow, c);
    result.push_back(blend(pool.counts[c], blend(groups[group_of(subject, c)], lean)));
  }
  return result;
}

}  // namespace gicodec::train
