#include "native/adaptation.h"

#include <algorithm>
#include <bit>
#include <iterator>

namespace gicodec::native {
namespace {

constexpr std::uint16_t kNoSlot = 0xFFFF;
constexpr std::uint64_t kTokenOverrideCost = 24 * 256;  // in 1/256 bits, about three bytes
constexpr std::uint64_t kHitOverrideCost = 40 * 256;
constexpr std::uint32_t kFewest = 16;  // counts below say little

unsigned token_of(std::uint16_t value) {
  if (value < kDirect) return value;
  const auto top = static_cast<unsigned>(std::bit_width(value)) - 1;
  return kDirect + 2 * (top - 4) + (value >> (top - 1) & 1U);
}

/// Cost of every token in every distribution, raw bits left out.
struct Prices {
  std::uint16_t price[kDistributions][64];
  explicit Prices(const Tables& t) noexcept : price{} {
    for (unsigned d = 0; d < kDistributions; ++d) {
      for (unsigned token = 0; token < kTokens; ++token) {
        price[d][token] = frequency_cost(t.codes[d * 64 + token] >> 12 & (kProbabilityScale - 1));
      }
    }
  }
};
const Prices& prices() {
  static const Prices p(tables(0, false));
  return p;
}

std::uint64_t cost(const std::array<std::uint32_t, 64>& counts, const std::uint16_t (&price)[64]) {
  std::uint64_t sum = 0;
  for (unsigned t = 0; t < kTokens; ++t) sum += std::uint64_t{counts[t]} * price[t];
  return sum;
}

std::uint64_t hit_cost_of(const std::array<std::uint32_t, 3>& n, std::uint32_t end0,
                          std::uint32_t end1) {
  return std::uint64_t{n[0]} * frequency_cost(end0) + std::uint64_t{n[1]} * frequency_cost(end1 - end0) +
         std::uint64_t{n[2]} * frequency_cost(kProbabilityScale - end1);
}

}  // namespace

const Tables& AdaptedTables::apply(const Tables& set, const Overrides& overrides) {
  if (overrides.empty()) return set;
  map_.assign(set.map, set.map + kContexts);
  for (const auto& o : overrides.tokens) {
    map_[o.context] = static_cast<std::uint32_t>(o.distribution) << kProbabilityBits;
  }
  std::copy_n(set.hits, 2 * kHitContexts, hits_);
  for (const auto& o : overrides.hits) {
    hits_[o.context] = o.end0;
    hits_[kHitContexts + o.context] = o.end1;
  }
  tables_ = {set.slots, set.codes, map_.data(), hits_};
  return tables_;
}

void Histogram::clear() {
  slot_.assign(kContexts, kNoSlot);
  contexts_.clear();
  counts_.clear();
  hits_ = {};
}

void Histogram::add(std::span<const Step> steps) {
  for (const Step& step : steps) {
    for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(rest));
      const std::uint16_t context = step.context[l];
      if (step.hit != 0) {
        ++hits_[context][step.value[l]];
        continue;
      }
      std::uint16_t& slot = slot_[context];
      if (slot == kNoSlot) {
        slot = static_cast<std::uint16_t>(contexts_.size());
        contexts_.push_back(context);
        counts_.push_back({});
      }
      ++counts_[slot][token_of(step.value[l])];
    }
  }
}

unsigned Histogram::best_set(bool update) const {
  unsigned best = 0;
  std::uint64_t least = UINT64_MAX;
  for (unsigned set = 0; set < kSets; ++set) {
    const Tables& t = tables(set, update);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < contexts_.size(); ++i) {
      sum += cost(counts_[i], prices().price[t.map[contexts_[i]] >> kProbabilityBits]);
    }
    for (unsigned c = 0; c < kHitContexts; ++c) {
      sum += hit_cost_of(hits_[c], t.hits[c], t.hits[kHitContexts + c]);
    }
    if (sum < least) {
      least = sum;
      best = set;
    }
  }
  return best;
}

void Histogram::choose(const Tables& set, std::uint32_t scale, Overrides& overrides) const {
  overrides.clear();
  for (std::size_t i = 0; i < contexts_.size(); ++i) {
    const Counts& counts = counts_[i];
    std::uint32_t total = 0;
    for (const auto n : counts) total += n;
    if (total < kFewest) continue;
    const std::uint64_t now = cost(counts, prices().price[set.map[contexts_[i]] >> kProbabilityBits]);
    unsigned best = 0;
    std::uint64_t least = UINT64_MAX;
    for (unsigned d = 0; d < kDistributions; ++d) {
      const std::uint64_t c = cost(counts, prices().price[d]);
      if (c < least) {
        least = c;
        best = d;
      }
    }
    if ((now - least) * scale > kTokenOverrideCost) {
      overrides.tokens.push_back({contexts_[i], static_cast<std::uint8_t>(best)});
    }
  }
  std::ranges::sort(overrides.tokens, {}, &Overrides::Token::context);
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
