#include "train/fit.h"

#include "base/parallel.h"
#include "native/planes/distribution_fit.h"
#include "train/cluster.h"
#include "train/prior.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

namespace gicodec::train {
namespace {

using Bits = std::array<float, native::kBins>;  ///< what values of each bin cost

float cost(const Counts& counts, const Bits& bits) {
  float c = 0;
  for (unsigned b = 0; b < native::kBins; ++b) c += static_cast<float>(counts[b]) * bits[b];
  return c;
}
double cost(const Weights& weights, const Bits& bits) {
  double c = 0;
  for (unsigned b = 0; b < native::kBins; ++b) c += weights[b] * bits[b];
  return c;
}
/// Raw bits that no distribution saves.
constexpr unsigned inner_bits(unsigned bin) { return bin < 8 ? 0 : (bin - 8) / 4 + 1; }

void fit_distribution(const Weights& weights, native::Distribution& out) {
  constexpr double kScale = 1 << 28;
  std::uint32_t counts[native::kBins];
  const double scale = kScale / std::max(sum(weights), 1e-9);
  for (unsigned b = 0; b < native::kBins; ++b) {
    counts[b] = static_cast<std::uint32_t>(std::lround(weights[b] * scale));
  }
  out = native::fit_distribution(counts);
}
void fit_distribution(const Weights& weights, RepeatEnds& out) {
  constexpr auto kWhole = native::kProbabilityScale;
  const double scale = kWhole / std::max(sum(weights), 1e-9);
  const auto slots = [&](unsigned symbol) {
    return std::max(1U, static_cast<unsigned>(std::lround(weights[symbol] * scale)));
  };
  const unsigned end0 = std::min(slots(0), kWhole - 2);
  const unsigned end1 = std::min(end0 + slots(1), kWhole - 1);
  out = {static_cast<std::uint16_t>(end0), static_cast<std::uint16_t>(end1)};
}

Bits bits_of(const native::Distribution& distribution) {
  Bits bits{};
  for (unsigned b = 0; b <= native::bin_of(0xFFFF); ++b) {
    bits[b] = static_cast<float>(native::price_of(distribution, b)) / 256.0F;
  }
  return bits;
}
Bits bits_of(const RepeatEnds& m) {
  Bits bits{};
  const unsigned slots[] = {m.end0, unsigned{m.end1} - m.end0, native::kProbabilityScale - m.end1};
  for (unsigned s = 0; s < 3; ++s)
    bits[s] = static_cast<float>(native::frequency_cost(slots[s])) / 256.0F;
  return bits;
}
/// Of an ideal code.
Bits bits_of(const Weights& p, bool repeats) {
  Bits bits;
  for (unsigned b = 0; b < native::kBins; ++b) {
    bits[b] = static_cast<float>(-std::log2(std::max(p[b], 1e-6)));
    if (!repeats) bits[b] += static_cast<float>(inner_bits(b));
  }
  return bits;
}

/// Costs of all contexts, by the number of what they share.
struct Code {
  std::vector<Bits> bits;
  std::array<std::uint8_t, native::kContexts> map;
};
double cost(const Histogram& h, const Code& code) {
  double c = 0;
  for (const auto& cell : h.cells) c += cost(cell.counts, code.bits[code.map[cell.context]]);
  return c;
}

Code ideal_code(Subject subject, const Pool& pool) {
  Code code;
  for (const auto& p : smooth(subject, pool))
    code.bits.push_back(bits_of(p, subject >= kRepeatTables));
  std::iota(code.map.begin(), code.map.end(), std::uint8_t{0});
  return code;
}

/// A distribution and its costs.
template <typename Distribution>
struct Priced {
  Distribution distribution;
  Bits bits;
};

/// The distributions of a pool's contexts.
template <typename Distribution>
DistributionTables<Distribution> fit_family(Subject subject, const Pool& pool) {
  auto items = smooth(subject, pool);
  for (unsigned c = 0; c < native::kContexts; ++c) {
    // Contexts that do not occur choose, but have no say.
    const double weight = sum(pool.counts[c]) + 1e-3;
    for (double& p : items[c]) p *= weight;
  }
  const auto fit = [&](const Items& owned) {
    Weights all{};
    for (const auto i : owned) {
      for (unsigned b = 0; b < native::kBins; ++b) all[b] += items[i][b];
    }
    Priced<Distribution> m;
    fit_distribution(all, m.distribution);
    m.bits = bits_of(m.distribution);
    return m;
  };
  const auto price = [&](std::size_t i, const Priced<Distribution>& m) {
    return cost(items[i], m.bits);
  };
  auto distributions = cluster(items.size(), native::kDistributions, fit, price);
  DistributionTables<Distribution> family;
  std::ranges::transform(distributions, family.distribution.begin(),
                         &Priced<Distribution>::distribution);
  for (unsigned c = 0; c < native::kContexts; ++c) {
    family.map[c] = static_cast<std::uint8_t>(Choice(c, price, distributions).model);
  }
  return family;
}

template <typename Distribution>
Code code_of(const DistributionTables<Distribution>& family) {
  Code code{{}, family.map};
  for (const auto& m : family.distribution) code.bits.push_back(bits_of(m));
  return code;
}
Code family_code(Subject subject, const Pool& pool) {
  return subject >= kRepeatTables ? code_of(fit_family<RepeatEnds>(subject, pool))
                                  : code_of(fit_family<native::Distribution>(subject, pool));
}

/// What each histogram counts for, so that textures of few bits have their say.
std::vector<double> weights_of(Subject subject, const std::vector<Histogram>& histograms) {
  constexpr double kPower = 0.5, kFewestBits = 1000;
  std::vector<double> weights;
  double bits = 0, weighted = 0;
  for (const auto& h : histograms) {
    Pool own;
    own.add(h, 1);
    const double c = std::max(cost(h, ideal_code(subject, own)), kFewestBits);
    weights.push_back(std::pow(c, -kPower));
    bits += c;
    weighted += c * weights.back();
  }
  for (double& w : weights) w *= bits / weighted;
  return weights;
}

/// What each set is fitted to.
using Pools = std::array<Pool, native::kSets>;

Pools cluster_sets(Subject subject, const std::vector<Histogram>& histograms) {
  const auto weights = weights_of(subject, histograms);
  const auto pool = [&](const Items& owned) {
    Pool p;
    for (const auto i : owned) p.add(histograms[i], weights[i]);
    return p;
  };
  const auto price = [&](std::size_t i, const Code& code) {
    return weights[i] * cost(histograms[i], code);
  };
  const auto ideal = [&](const Items& owned) { return ideal_code(subject, pool(owned)); };
  const auto exact = [&](const Items& owned) { return family_code(subject, pool(owned)); };
  auto codes = cluster(histograms.size(), native::kSets, ideal, price);
  const auto owned = settle(histograms.size(), exact, price, codes);
  Pools pools;
  double bits = 0;
  for (unsigned k = 0; k < native::kSets; ++k) {
    pools[k] = pool(owned[k]);
    for (const auto i : owned[k]) bits += cost(histograms[i], codes[k]);
  }
  std::cerr << fmt::format("subject {}: {} histograms, {:.0f} KB\n", unsigned{subject},
                           histograms.size(), bits / 8e3);
  return pools;
}

}  // namespace

void fit(const std::array<std::vector<Histogram>, kSubjects>& histograms, unsigned threads,
         Model& model) {
  std::array<Pools, kSubjects> pools;
  for_each_item(threads, kSubjects, [&](unsigned, std::size_t subject) {
    pools[subject] = cluster_sets(Subject(subject), histograms[subject]);
  });
  for (unsigned kind = 1; kind < kRepeatTables - kModes; ++kind) {
    for (unsigned set = 0; set < native::kSets; ++set) {
      pools[kModes][set].add(pools[kModes + kind][set]);
    }
  }
  for (unsigned set = 0; set < native::kSets; ++set) {
    for (unsigned role = 0; role < native::kRoles; ++role) {
      model.role[role][set] = fit_family<native::Distribution>(Subject(role), pools[role][set]);
    }
    for (unsigned update = 0; update < 2; ++update) {
      model.repeats[update][set] = fit_family<RepeatEnds>(Subject(kRepeatTables + update),
                                                          pools[kRepeatTables + update][set]);
    }
  }
}

}  // namespace gicodec::train
