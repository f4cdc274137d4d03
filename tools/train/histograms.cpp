#include "train/histograms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace gicodec::train {
namespace {

using native::kTokens;

float sum(const Distribution& d) { return std::accumulate(d.begin(), d.end(), 0.0F); }
unsigned token_of(unsigned value) {
  if (value < native::kDirect) return value;
  const auto top = static_cast<unsigned>(std::bit_width(value)) - 1;
  return native::kDirect + 2 * (top - 4) + (value >> (top - 1) & 1);
}

/// What a context looks like before anything was seen: two-sided geometric values whose scale
/// follows the magnitude class.
Distribution prior(unsigned context) {
  const unsigned klass = context % native::kRowSize % native::kMagnitudes;
  const float s = klass == 0 ? 0.3F
                  : klass <= std::size(native::kThresholds)
                      ? static_cast<float>(native::kThresholds[klass - 1])
                      : 64.0F;
  const float theta = std::exp(-1.0F / (s / 6 * 2 + 0.3F));  // of zigzag values
  Distribution d{};
  for (unsigned value = 0; value < 16; ++value)
    d[value] = std::pow(theta, static_cast<float>(value));
  for (unsigned token = 16; token < kTokens; ++token) {
    const unsigned top = 4 + (token - 16) / 2;
    const float begin = static_cast<float>((2 + (token & 1)) << (top - 1));
    const float end = begin + static_cast<float>(1U << (top - 1));
    d[token] = (std::pow(theta, begin) - std::pow(theta, end)) / (1 - theta);
  }
  const float total = sum(d);
  for (auto& p : d) p = p / total * 0.999F + 0.001F / kTokens;
  return d;
}

/// Counts plus `weight` times a distribution, as a distribution.
Distribution blend(const Distribution& counts, const Distribution& with, float weight) {
  Distribution d;
  const float total = sum(counts) + weight;
  for (unsigned t = 0; t < kTokens; ++t) d[t] = (counts[t] + weight * with[t]) / total;
  return d;
}
constexpr float kWeight = 24;

Distribution logarithms(const Distribution& d) {
  Distribution l;
  for (unsigned t = 0; t < kTokens; ++t) l[t] = -std::log2(std::max(d[t], 1.0F / 4096));
  return l;
}
float cost(const Distribution& counts, const Distribution& bits) {
  float c = 0;
  for (unsigned t = 0; t < kTokens; ++t) c += counts[t] * bits[t];
  return c;
}

/// Smoothed distributions of pooled counts: each context leans on the same class over all modes,
/// that on the prior.
std::vector<Distribution> smooth(const Histogram& h) {
  std::vector<Distribution> over_modes(kContexts, Distribution{});
  const auto group_of = [](unsigned context) {
    const unsigned row = context / native::kRowSize;
    return row < native::kModeRow ? row / native::kModes * native::kModes * native::kRowSize +
                                        context % native::kRowSize
                                  : context;
  };
  for (unsigned c = 0; c < kContexts; ++c) {
    auto& to = over_modes[group_of(c)];
    for (unsigned t = 0; t < kTokens; ++t) to[t] += h.tokens[c][t];
  }
  std::vector<Distribution> result(kContexts);
  for (unsigned c = 0; c < kContexts; ++c) {
    result[c] = blend(h.tokens[c], blend(over_modes[group_of(c)], prior(c), kWeight), kWeight);
  }
  return result;
}

std::vector<HitDistribution> smooth_hits(const Histogram& h) {
  std::vector<HitDistribution> result(native::kHitContexts);
  for (unsigned c = 0; c < native::kHitContexts; ++c) {
    const auto& n = h.hits[c];
    const float total = n[0] + n[1] + n[2] + 3;
    for (unsigned s = 0; s < 3; ++s) result[c][s] = (n[s] + 1) / total;
  }
  return result;
}

struct Set {
  Histogram pooled;
  std::vector<Distribution> bits;
  std::vector<HitDistribution> hit_bits;
};

float cost(const Histogram& h, const Set& set) {
  float c = 0;
  for (unsigned i = 0; i < kContexts; ++i) {
    if (sum(h.tokens[i]) > 0) c += cost(h.tokens[i], set.bits[i]);
  }
  for (unsigned i = 0; i < native::kHitContexts; ++i) {
    for (unsigned s = 0; s < 3; ++s) c += h.hits[i][s] * set.hit_bits[i][s];
  }
  return c;
}

void estimate(Set& set) {
  set.bits.clear();
  for (const auto& d : smooth(set.pooled)) set.bits.push_back(logarithms(d));
  set.hit_bits = smooth_hits(set.pooled);
  for (auto& d : set.hit_bits) {
    for (auto& p : d) p = -std::log2(p);
  }
}

/// k-means of one kind's sources by code length.
std::array<Set, native::kSets> cluster(const std::vector<Histogram>& sources) {
  std::array<Set, native::kSets> sets;
  std::vector<unsigned> owner(sources.size(), 0);
  for (const auto& s : sources) sets[0].pooled.add(s);
  for (auto& set : sets) {
    set.pooled = sets[0].pooled;
    estimate(set);
  }
  for (unsigned k = 1; k < native::kSets && !sources.empty(); ++k) {
    // The source that the sets so far serve worst, against its own tables, opens the next one.
    float worst = -1;
    std::size_t at = 0;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      Set own;
      own.pooled = sources[i];
      estimate(own);
      float best = cost(sources[i], sets[0]);
      for (unsigned j = 1; j < k; ++j) best = std::min(best, cost(sources[i], sets[j]));
      const float loss = best - cost(sources[i], own);
      if (loss > worst) {
        worst = loss;
        at = i;
      }
    }
    sets[k].pooled = sources[at];
    estimate(sets[k]);
  }
  for (int round = 0; round < 8; ++round) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
      unsigned best = 0;
      for (unsigned k = 1; k < native::kSets; ++k) {
        if (cost(sources[i], sets[k]) < cost(sources[i], sets[best])) best = k;
      }
      owner[i] = best;
    }
    for (unsigned k = 0; k < native::kSets; ++k) {
      Set next;
      bool any = false;
      for (std::size_t i = 0; i < sources.size(); ++i) {
        if (owner[i] != k) continue;
        next.pooled.add(sources[i]);
        any = true;
      }
      if (!any) continue;
      estimate(next);
      sets[k] = std::move(next);
    }
  }
  return sets;
}

/// k-means of context distributions by code length, heaviest first.
void fit_family(const std::vector<Distribution>& items, const std::vector<float>& weight,
                Model& model, std::vector<std::uint8_t>& owner) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<float> mean(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) mean[i] = cost(items[i], logarithms(items[i]));
  std::ranges::sort(order, [&](auto a, auto b) { return mean[a] < mean[b]; });
  // Start from equal shares of the square root of the weight along the order of entropy.
  double total = 0, seen = 0;
  for (const auto w : weight) total += std::sqrt(w);
  std::array<Distribution, native::kDistributions> counts{};
  for (const auto i : order) {
    const auto k =
        std::min<std::size_t>(native::kDistributions - 1,
                              static_cast<std::size_t>(seen / total * native::kDistributions));
    for (unsigned t = 0; t < kTokens; ++t) counts[k][t] += weight[i] * items[i][t];
    seen += std::sqrt(weight[i]);
  }
  owner.assign(items.size(), 0);
  for (int round = 0; round < 40; ++round) {
    std::array<Distribution, native::kDistributions> bits;
    for (unsigned k = 0; k < native::kDistributions; ++k) {
      const float n = sum(counts[k]);
      for (unsigned t = 0; t < kTokens; ++t)
        model.family[k][t] = n > 0 ? counts[k][t] / n : 1.0F / kTokens;
      const auto frequency = quantise(model.family[k]);
      for (unsigned t = 0; t < kTokens; ++t)
        bits[k][t] = 12 - std::log2(static_cast<float>(frequency[t]));
    }
    counts = {};
    for (std::size_t i = 0; i < items.size(); ++i) {
      unsigned best = 0;
      float least = cost(items[i], bits[0]);
      for (unsigned k = 1; k < native::kDistributions; ++k) {
        const float c = cost(items[i], bits[k]);
        if (c < least) {
          least = c;
          best = k;
        }
      }
      owner[i] = static_cast<std::uint8_t>(best);
      for (unsigned t = 0; t < kTokens; ++t) counts[best][t] += weight[i] * items[i][t];
    }
  }
}

}  // namespace

void Histogram::add(const native::Step* begin, const native::Step* end) {
  for (const auto* s = begin; s != end; ++s) {
    for (std::uint32_t rest = s->active; rest != 0; rest &= rest - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(rest));
      if (s->hit != 0) {
        hits[s->context[l]][s->value[l]] += 1;
      } else {
        tokens[s->context[l]][token_of(s->value[l])] += 1;
      }
    }
  }
}

void Histogram::add(const Histogram& other) {
  for (unsigned c = 0; c < kContexts; ++c) {
    for (unsigned t = 0; t < kTokens; ++t) tokens[c][t] += other.tokens[c][t];
  }
  for (unsigned c = 0; c < native::kHitContexts; ++c) {
    for (unsigned s = 0; s < 3; ++s) hits[c][s] += other.hits[c][s];
  }
}

Model fit(const std::vector<Kind>& kinds) {
  Model model;
  std::array<Histogram, native::kSets> all;
  for (const auto& kind : kinds) {
    const auto sets = cluster(kind.sources);
    for (unsigned k = 0; k < native::kSets; ++k) {
      all[k].add(sets[k].pooled);
      if (std::ranges::any_of(sets[k].pooled.hits,
                              [](const auto& h) { return h[0] + h[1] + h[2] > 0; }) ||
          model.hits[k][kind.update].empty()) {
        model.hits[k][kind.update] = smooth_hits(sets[k].pooled);
      }
    }
  }
  std::vector<Distribution> items;
  std::vector<float> weight;
  for (const auto& h : all) {
    const auto d = smooth(h);
    for (unsigned c = 0; c < kContexts; ++c) {
      items.push_back(d[c]);
      weight.push_back(sum(h.tokens[c]) + 0.01F);
    }
  }
  std::vector<std::uint8_t> owner;
  fit_family(items, weight, model, owner);
  for (unsigned k = 0; k < native::kSets; ++k) {
    const std::uint8_t* first = owner.data() + std::size_t{k} * kContexts;
    model.map[k].assign(first, first + kContexts);
    for (auto& hits : model.hits[k]) {
      if (hits.empty()) hits = smooth_hits(Histogram{});
    }
  }
  return model;
}

std::array<unsigned, kTokens> quantise(const Distribution& p) {
  std::array<unsigned, kTokens> f;
  const float total = sum(p);
  const unsigned spare = native::kProbabilityScale - kTokens;
  unsigned used = 0;
  std::array<float, kTokens> rest;
  for (unsigned t = 0; t < kTokens; ++t) {
    // At least 1 each; the remainder in proportion to what lies above that.
    const float share = std::max(0.0F, p[t] / total - 1.0F / native::kProbabilityScale);
    rest[t] = share;
  }
  const float above = std::max(sum(rest), 1e-9F);
  for (unsigned t = 0; t < kTokens; ++t) {
    f[t] = 1 + static_cast<unsigned>(rest[t] / above * static_cast<float>(spare));
    used += f[t];
  }
  const auto top = static_cast<std::size_t>(std::ranges::max_element(f) - f.begin());
  f[top] += native::kProbabilityScale - used;
  return f;
}

}  // namespace gicodec::train
