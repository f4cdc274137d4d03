#include "native/adaptation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

namespace gicodec::native {
namespace {

constexpr std::uint16_t kNoSlot = 0xFFFF;
constexpr std::uint64_t kTokenOverrideCost = 24 * 256;  // in 1/256 bits, about three bytes
constexpr std::uint64_t kHitOverrideCost = 40 * 256;
constexpr std::uint32_t kFewest = 16;       // counts below say little
constexpr std::uint32_t kFewestInAll = 32;  // symbols that may pay an override

/// Cost of every token in one distribution, raw bits left out.
using Prices = std::array<std::int16_t, kTokens>;

Prices prices_of(const std::uint16_t* frequency) {
  Prices p;
  for (unsigned t = 0; t < kTokens; ++t) {
    p[t] = static_cast<std::int16_t>(frequency_cost(frequency[t]));
  }
  return p;
}

struct FamilyPrices {
  std::array<Prices, kDistributions> member;
  FamilyPrices() noexcept {
    for (unsigned d = 0; d < kDistributions; ++d) member[d] = prices_of(kTableData.frequency[d]);
  }
};
const std::array<Prices, kDistributions>& family_prices() {
  static const FamilyPrices prices;
  return prices.member;
}

/// Products of signed words, which every machine has an instruction for.
std::uint32_t cost(const std::array<std::int16_t, kTokens>& counts, const Prices& price) {
  std::int32_t sum = 0;
  for (unsigned t = 0; t < kTokens; ++t) sum += counts[t] * price[t];
  return static_cast<std::uint32_t>(sum);
}
constexpr std::uint32_t kMostCounts = INT16_MAX;

std::uint64_t hit_cost_of(const std::array<std::uint32_t, 3>& n, std::uint32_t end0,
                          std::uint32_t end1) {
  return std::uint64_t{n[0]} * frequency_cost(end0) +
         std::uint64_t{n[1]} * frequency_cost(end1 - end0) +
         std::uint64_t{n[2]} * frequency_cost(kProbabilityScale - end1);
}

}  // namespace

const Tables& AdaptedTables::apply(const Tables& set, const Overrides& overrides) {
  if (overrides.empty()) return set;
  map_.assign(set.map, set.map + kContexts);
  for (const auto& o : overrides.tokens) map_[o.context] = o.distribution;
  std::copy_n(set.hits, 2 * kHitContexts, hits_);
  for (const auto& o : overrides.hits) {
    hits_[o.context] = o.end0;
    hits_[kHitContexts + o.context] = o.end1;
  }
  tables_ = {set.family, map_.data(), hits_};
  if (overrides.members.empty()) return tables_;
  if (family_.empty()) {
    decltype(family_) family(kDistributions + kMaxMembers);
    std::copy_n(set.family, kDistributions, family.begin());
    family_ = std::move(family);  // Whole or not at all: what is written below relies on its size.
  }
  for (unsigned m = 0; m < overrides.members.size(); ++m) {
    build_distribution(overrides.members[m].data(), family_[kDistributions + m]);
  }
  tables_.family = family_.data();
  return tables_;
}

void Histogram::clear() {
  slot_.assign(kContexts, kNoSlot);
  contexts_.clear();
  counts_.clear();
  seen_.clear();
  hits_ = {};
}

void Histogram::add(std::span<const Step> steps) {
  // By plain pointers: in small packets nothing else takes as long.
  std::uint16_t* const slots = slot_.data();
  for (const Step& step : steps) {
    if (step.hit != 0) {
      for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
        const auto l = static_cast<unsigned>(std::countr_zero(rest));
        ++hits_.data()[step.context[l]].data()[step.value[l]];
      }
      continue;
    }
    for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(rest));
      std::uint16_t& slot = slots[step.context[l]];
      if (slot == kNoSlot) {
        slot = static_cast<std::uint16_t>(contexts_.size());
        contexts_.push_back(step.context[l]);
        counts_.push_back({});
        seen_.push_back(0);
      }
      std::uint32_t& seen = seen_.data()[slot];
      if (seen == kMostCounts) continue;
      ++seen;
      ++counts_.data()[slot].data()[token_of(step.value[l])];
    }
  }
}

Histogram::Fit Histogram::best_set(bool update) const {
  static constexpr Prices kRawBits = [] {
    Prices p{};
    for (unsigned t = kDirect; t < kTokens; ++t) {
      p[t] = static_cast<std::int16_t>(256 * raw_bits_of(t));
    }
    return p;
  }();
  const auto& family_price = family_prices();
  Fit best{0, 0};
  std::uint64_t least = UINT64_MAX, raw = 0;
  for (const Counts& counts : counts_) raw += cost(counts, kRawBits);
  for (unsigned set = 0; set < kSets; ++set) {
    const Tables& t = tables(set, update);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < contexts_.size(); ++i) {
      sum += cost(counts_[i], family_price[t.map[contexts_[i]]]);
    }
    for (unsigned c = 0; c < kHitContexts; ++c) {
      sum += hit_cost_of(hits_[c], t.hits[c], t.hits[kHitContexts + c]);
    }
    if (sum < least) {
      least = sum;
      best = {set, (sum + raw) / (8 * 256)};
    }
  }
  return best;
}

namespace {

using Weights = std::array<float, kTokens>;

/// n·log2(n) in 1/256 bits.
float log_weight(unsigned n) noexcept {
  struct Table {
    std::array<float, 512> of{};
    Table() noexcept {
      for (unsigned n = 1; n < of.size(); ++n) of[n] = weight(n);
    }
    static float weight(unsigned n) noexcept {
      return 256 * static_cast<float>(n) * std::log2(static_cast<float>(n));
    }
  };
  static const Table table;
  return n < table.of.size() ? table.of[n] : Table::weight(n);
}
/// No distribution codes the counts in less, in 1/256 bits; prices are rounded.
std::uint64_t least_cost(const std::array<std::int16_t, kTokens>& counts, std::uint32_t total) {
  float sum = log_weight(total) - static_cast<float>(total);
  for (const auto n : counts) sum -= log_weight(static_cast<unsigned>(n));
  return static_cast<std::uint64_t>(std::max(sum, 0.0F));
}

Frequencies quantise(const Weights& counts) {
  float total = 0;
  for (const auto n : counts) total += n;
  Frequencies f;
  std::uint32_t used = 0;
  const float scale = static_cast<float>(kProbabilityScale - kTokens) / total;
  for (unsigned t = 0; t < kTokens; ++t) {
    f[t] = static_cast<std::uint16_t>(1 + static_cast<std::int32_t>(counts[t] * scale));
    used += f[t];
  }
  auto& most = *std::max_element(f.begin(), f.end());
  most = static_cast<std::uint16_t>(
      std::min<std::uint32_t>(most + kProbabilityScale - used, kProbabilityScale - 1));
  return f;
}
/// Bytes of a member in the head: tokens after the last frequent one are left out.
std::uint64_t member_cost(const Frequencies& f) {
  std::uint64_t bytes = 1;
  unsigned n = kTokens;
  while (n > 1 && f[n - 1] == 1) --n;
  for (unsigned t = 1; t < n; ++t) bytes += f[t] > 128 ? 2 : 1;
  return bytes * 8 * 256;
}

/// A context that the family does not serve well.
struct Wanting {
  std::size_t at;           ///< in the histogram
  std::uint64_t now, best;  ///< cost under the set and under the best of the family
  std::uint8_t member;
  std::uint64_t gain;  ///< of a distribution of its own
};

}  // namespace

void Histogram::choose(const Tables& set, std::uint32_t scale, unsigned effort,
                       Overrides& overrides) const {
  overrides.clear();
  const auto& family_price = family_prices();
  std::vector<Wanting> wanting;
  for (std::size_t i = 0; i < contexts_.size(); ++i) {
    const Counts& counts = counts_[i];
    Weights weights;
    if (seen_[i] < kFewest || seen_[i] * scale < kFewestInAll) continue;
    Wanting w{i, cost(counts, family_price[set.map[contexts_[i]]]), UINT64_MAX, 0, 0};
    if ((w.now - std::min(w.now, least_cost(counts, seen_[i]))) * scale < kTokenOverrideCost)
      continue;
    for (unsigned t = 0; t < kTokens; ++t) weights[t] = static_cast<float>(counts[t]);
    const std::uint64_t own = cost(counts, prices_of(quantise(weights).data()));
    if ((w.now - std::min(w.now, own)) * scale < kTokenOverrideCost) continue;
    for (unsigned d = 0; d < kDistributions; ++d) {
      const std::uint64_t c = cost(counts, family_price[d]);
      if (c < w.best) {
        w.best = c;
        w.member = static_cast<std::uint8_t>(d);
      }
    }
    w.gain = w.best - std::min(w.best, own);
    wanting.push_back(w);
  }

  // Members: k-means from the contexts that want one most.
  std::sort(wanting.begin(), wanting.end(),
            [](const Wanting& a, const Wanting& b) { return a.gain > b.gain; });
  const std::size_t tries = std::min<std::size_t>({effort, kMaxMembers, wanting.size()});
  std::vector<Frequencies> members(tries);
  std::vector<Prices> price(tries);
  const auto pool = [&](std::size_t k, const auto& belongs) {
    Weights sum{};
    for (std::size_t i = 0; i < wanting.size(); ++i) {
      if (!belongs(i)) continue;
      for (unsigned t = 0; t < kTokens; ++t)
        sum[t] += static_cast<float>(counts_[wanting[i].at][t]);
    }
    if (std::all_of(sum.begin(), sum.end(), [](float n) { return n == 0; })) return;
    members[k] = quantise(sum);
    price[k] = prices_of(members[k].data());
  };
  for (std::size_t k = 0; k < tries; ++k) pool(k, [k](std::size_t i) { return i == k; });
  std::vector<std::size_t> owner(wanting.size());
  std::vector<std::uint64_t> served(wanting.size());
  const auto assign = [&] {
    for (std::size_t i = 0; i < wanting.size(); ++i) {
      owner[i] = kMaxMembers;
      served[i] = wanting[i].best;
      for (std::size_t k = 0; k < members.size(); ++k) {
        const std::uint64_t c = cost(counts_[wanting[i].at], price[k]);
        if (c < served[i]) {
          served[i] = c;
          owner[i] = k;
        }
      }
    }
  };
  for (int round = 0; round < 3 && tries > 0; ++round) {
    assign();
    for (std::size_t k = 0; k < tries; ++k) pool(k, [&](std::size_t i) { return owner[i] == k; });
  }
  assign();
  for (std::size_t k = members.size(); k-- > 0;) {  // those that do not pay for themselves go
    std::uint64_t saved = 0;
    for (std::size_t i = 0; i < wanting.size(); ++i) {
      if (owner[i] == k) saved += (wanting[i].best - served[i]) * scale;
    }
    if (saved > member_cost(members[k])) continue;
    members.erase(members.begin() + static_cast<std::ptrdiff_t>(k));
    price.erase(price.begin() + static_cast<std::ptrdiff_t>(k));
    assign();
  }

  for (std::size_t i = 0; i < wanting.size(); ++i) {
    if ((wanting[i].now - std::min(wanting[i].now, served[i])) * scale <= kTokenOverrideCost)
      continue;
    const std::size_t d = owner[i] < kMaxMembers ? kDistributions + owner[i] : wanting[i].member;
    overrides.tokens.push_back({contexts_[wanting[i].at], static_cast<std::uint8_t>(d)});
  }
  std::sort(overrides.tokens.begin(), overrides.tokens.end(),
            [](const auto& a, const auto& b) { return a.context < b.context; });
  if (!overrides.tokens.empty()) overrides.members = std::move(members);
  choose_hits(set, scale, overrides);
}

void Histogram::choose_hits(const Tables& set, std::uint32_t scale, Overrides& overrides) const {
  for (unsigned c = 0; c < kHitContexts; ++c) {
    const auto& n = hits_[c];
    const std::uint32_t total = n[0] + n[1] + n[2];
    if (total < kFewest) continue;
    const auto share = [total](std::uint64_t count) {
      return static_cast<std::uint32_t>((count * kProbabilityScale + total / 2) / (total + 1));
    };
    const std::uint32_t end0 = std::clamp(share(n[0]), 1U, kProbabilityScale - 2);
    const std::uint32_t end1 = std::clamp(share(n[0] + n[1]), end0 + 1, kProbabilityScale - 1);
    const std::uint64_t now = hit_cost_of(n, set.hits[c], set.hits[kHitContexts + c]);
    const std::uint64_t then = hit_cost_of(n, end0, end1);
    if (now > then && (now - then) * scale > kHitOverrideCost) {
      overrides.hits.push_back({static_cast<std::uint8_t>(c), static_cast<std::uint16_t>(end0),
                                static_cast<std::uint16_t>(end1)});
    }
  }
}

}  // namespace gicodec::native
