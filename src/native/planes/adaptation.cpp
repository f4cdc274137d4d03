#include "native/planes/adaptation.h"

#include "native/planes/distribution_fit.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

constexpr std::uint16_t kNoSlot = 0xFFFF;
constexpr std::uint16_t kMaxCounts = INT16_MAX;
constexpr int kRounds = 2;
constexpr std::uint64_t kMovedCost = 16 * 256;  // in 1/256 bits
constexpr std::uint64_t kOwnRepeatsCost = (1 + 4 * kDistributions + kRepeatContexts / 2) * 8 * 256;

std::uint64_t distribution_cost(const Distribution& m) {
  return std::uint64_t{4 + listed_symbols(m)} * 8 * 256;
}

}  // namespace

void TableChoice::clear() {
  std::fill(std::begin(set), std::end(set), std::uint8_t{0});
  for (auto& o : overrides) o.clear();
  repeats.distributions = 0;
}

const Tables& AdaptedTables::apply(bool pairs, bool update, const TableChoice& choice) {
  const unsigned residuals = residual_places(pairs);
  if (choice.overridden() && role_.size() < 3) role_.resize(3);
  for (unsigned p = 0; p < kPlaces; ++p) tables_.role[p] = nullptr;
  for (unsigned p = 0; p < residuals; ++p) {
    const RoleTables& set = role_tables(role_of(pairs, update, p), choice.set[p]);
    tables_.role[p] = &set;
    const Overrides& overrides = choice.overrides[p];
    if (overrides.empty()) continue;
    RoleTables& own = role_[p];
    own = set;
    for (const auto& r : overrides.distributions) build_distribution(r.distribution, r.number, own);
    for (const auto& m : overrides.contexts) own.map[m.context] = m.distribution;
    tables_.role[p] = &own;
  }
  tables_.role[kModePlace] = &role_tables(kModeRole, choice.set[kModePlace]);
  if (pairs) tables_.repeats = &repeat_tables(update, choice.set[kRepeatPlace]);
  if (choice.repeats.distributions == 0) return tables_;
  repeats_ = {};
  for (unsigned m = 0; m < choice.repeats.distributions; ++m) {
    build_repeats(m, choice.repeats.end[m][0], choice.repeats.end[m][1], repeats_);
  }
  std::copy_n(choice.repeats.map, kRepeatContexts, repeats_.map);
  tables_.repeats = &repeats_;
  return tables_;
}

void Histogram::clear() {
  for (Place& place : places_) {
    place.slot.fill(kNoSlot);
    place.contexts.clear();
    place.counts.clear();
    place.seen.clear();
  }
  repeats_ = {};
}

void Histogram::add(std::span<const Step> steps) {
  for (const Step& step : steps) {
    if (step.repeat != 0) {
      for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
        const auto l = static_cast<unsigned>(std::countr_zero(rest));
        ++repeats_.data()[step.context[l]].data()[step.value[l]];
      }
      continue;
    }
    Place& place = places_[step.place];
    for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(rest));
      const unsigned context = step.context[l];
      std::uint16_t& slot = place.slot.data()[context];
      if (slot == kNoSlot) {
        slot = static_cast<std::uint16_t>(place.contexts.size());
        place.contexts.push_back(static_cast<std::uint8_t>(context));
        place.counts.emplace_back();
        place.seen.push_back(0);
      }
      std::uint16_t& seen = place.seen.data()[slot];
      if (seen == kMaxCounts) continue;
      ++seen;
      ++place.counts.data()[slot].of.data()[find_bin(step.value[l])];
    }
  }
}

/// Products of signed words, which every machine has an instruction for.
std::uint32_t Histogram::cost(const Counts& counts, const std::int16_t* price) {
  std::int32_t sum = 0;
  for (unsigned b = 0; b < kBins; ++b) sum += counts.of[b] * price[b];
  return static_cast<std::uint32_t>(sum);
}

std::uint64_t Histogram::cost_of(const Place& place, const RoleTables& tables) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < place.contexts.size(); ++i) {
    sum += cost(place.counts[i], tables.price[tables.map[place.contexts[i]]]);
  }
  return sum;
}

std::uint64_t Histogram::cost(const RepeatCounts& n, std::uint32_t end0, std::uint32_t end1) {
  return std::uint64_t{n[0]} * frequency_cost(end0) +
         std::uint64_t{n[1]} * frequency_cost(end1 - end0) +
         std::uint64_t{n[2]} * frequency_cost(kProbabilityScale - end1);
}

std::uint64_t Histogram::cost_of(const RepeatTables& tables) const {
  std::uint64_t sum = 0;
  for (unsigned c = 0; c < kRepeatContexts; ++c) {
    if (repeats_[c] != RepeatCounts{}) sum += cost(repeats_[c], tables.end(0, c), tables.end(1, c));
  }
  return sum;
}

std::uint64_t Histogram::choose_sets(bool pairs, bool update, TableChoice& choice) const {
  std::uint64_t total = 0;
  for (unsigned p = 0; p < kPlaces; ++p) {
    const bool of_repeats = pairs && p == kRepeatPlace;
    const unsigned role = p == kModePlace ? kModeRole : role_of(pairs, update, p);
    if (!of_repeats && places_[p].contexts.empty()) continue;
    std::uint64_t least = UINT64_MAX;
    for (unsigned set = 0; set < kSets; ++set) {
      const std::uint64_t c = of_repeats ? cost_of(repeat_tables(update, set))
                                         : cost_of(places_[p], role_tables(role, set));
      if (c >= least) continue;
      least = c;
      choice.set[p] = static_cast<std::uint8_t>(set);
    }
    total += least;
  }
  return total / (8 * 256);
}

void Histogram::choose_overrides(bool pairs, bool update, std::uint32_t scale,
                                 TableChoice& choice) const {
  for (unsigned p = 0; p < residual_places(pairs); ++p) {
    override_place(places_[p], role_of(pairs, update, p), choice.set[p], scale,
                   choice.overrides[p]);
  }
  if (!pairs) return;
  override_repeats(repeat_tables(update, choice.set[kRepeatPlace]), scale, choice.repeats);
  if (choice.repeats.distributions > 0) choice.set[kRepeatPlace] = 0;
}

void Histogram::fit_repeats(bool update, std::uint32_t scale, OwnRepeats& own) const {
  override_repeats(repeat_tables(update, 0), scale, own);
  own.distributions = kDistributions;
}

/// Contexts choose distributions and distributions fit their contexts, in turns, as far as both
/// pay.
void Histogram::override_place(const Place& place, unsigned role, unsigned set, std::uint32_t scale,
                               Overrides& overrides) {
  const RoleTables& tables = role_tables(role, set);
  std::array<Distribution, kDistributions> distribution;
  std::array<std::array<std::int16_t, kBins>, kDistributions> price;
  std::array<bool, kDistributions> replaced{};
  for (unsigned m = 0; m < kDistributions; ++m) {
    distribution[m] = distribution_of(role, set, m);
    std::copy_n(tables.price[m], kBins, price[m].data());
  }
  const std::size_t n = place.contexts.size();
  std::array<std::uint8_t, kContexts> owner;
  const auto assign = [&] {
    for (std::size_t i = 0; i < n; ++i) {
      const unsigned home = tables.map[place.contexts[i]];
      std::uint64_t least = std::uint64_t{cost(place.counts[i], price[home].data())} * scale;
      owner[i] = static_cast<std::uint8_t>(home);
      if (least <= kMovedCost) continue;
      for (unsigned m = 0; m < kDistributions; ++m) {
        const std::uint64_t c =
            std::uint64_t{cost(place.counts[i], price[m].data())} * scale + kMovedCost;
        if (m == home || c >= least) continue;
        least = c;
        owner[i] = static_cast<std::uint8_t>(m);
      }
    }
  };
  for (int round = 0; round < kRounds; ++round) {
    assign();
    for (unsigned m = 0; m < kDistributions; ++m) {
      std::uint32_t pooled[kBins] = {};
      std::uint64_t before = 0, after = 0, seen = 0;
      for (std::size_t i = 0; i < n; ++i) {
        if (owner[i] != m) continue;
        for (unsigned b = 0; b < kBins; ++b) {
          pooled[b] += static_cast<std::uint32_t>(place.counts[i].of[b]);
        }
        before += cost(place.counts[i], tables.price[m]);
        seen += place.seen[i];
      }
      // What can be saved is a share of the cost.
      if (seen == 0 || before * scale < 4 * distribution_cost(distribution[m])) continue;
      const Distribution fitted = fit_distribution(pooled);
      std::array<std::int16_t, kBins> fitted_price;
      for (unsigned b = 0; b < kBins; ++b) {
        fitted_price[b] = price_of(fitted, b);
        after += std::uint64_t{pooled[b]} * static_cast<std::uint64_t>(fitted_price[b]);
      }
      replaced[m] = (before - std::min(before, after)) * scale > distribution_cost(fitted);
      distribution[m] = replaced[m] ? fitted : distribution_of(role, set, m);
      if (replaced[m]) {
        price[m] = fitted_price;
      } else {
        std::copy_n(tables.price[m], kBins, price[m].data());
      }
    }
  }
  assign();
  for (unsigned m = 0; m < kDistributions; ++m) {
    if (replaced[m])
      overrides.distributions.push_back({static_cast<std::uint8_t>(m), distribution[m]});
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (owner[i] != tables.map[place.contexts[i]]) {
      overrides.contexts.push_back({place.contexts[i], owner[i]});
    }
  }
  std::sort(overrides.contexts.begin(), overrides.contexts.end(),
            [](const auto& a, const auto& b) { return a.context < b.context; });
}

void Histogram::override_repeats(const RepeatTables& set, std::uint32_t scale,
                                 OwnRepeats& own) const {
  own.distributions = 0;
  std::copy_n(set.map, kRepeatContexts, own.map);
  for (unsigned m = 0; m < kDistributions; ++m) {
    for (unsigned k = 0; k < 2; ++k) {
      own.end[m][k] = set.end_of(k, m);
    }
  }
  std::uint64_t total = 0;
  for (int round = 0; round <= kRounds; ++round) {
    total = 0;
    std::array<RepeatCounts, kDistributions> pooled{};
    for (unsigned c = 0; c < kRepeatContexts; ++c) {
      if (repeats_[c] == RepeatCounts{}) continue;
      std::uint64_t least = UINT64_MAX;
      for (unsigned m = 0; m < kDistributions; ++m) {
        const std::uint64_t with = cost(repeats_[c], own.end[m][0], own.end[m][1]);
        if (with >= least) continue;
        least = with;
        own.map[c] = static_cast<std::uint8_t>(m);
      }
      total += least;
      for (unsigned s = 0; s < 3; ++s) pooled[own.map[c]][s] += repeats_[c][s];
    }
    if (round == kRounds) break;
    for (unsigned m = 0; m < kDistributions; ++m) {
      const RepeatCounts& n = pooled[m];
      const std::uint64_t sum = std::uint64_t{n[0]} + n[1] + n[2];
      if (sum == 0) continue;
      const auto share = [sum](std::uint64_t count) {
        return static_cast<std::uint32_t>((count * kProbabilityScale + sum / 2) / (sum + 1));
      };
      const std::uint32_t end0 = std::clamp(share(n[0]), 1U, kProbabilityScale - 2);
      const std::uint32_t end1 =
          std::clamp(share(std::uint64_t{n[0]} + n[1]), end0 + 1, kProbabilityScale - 1);
      own.end[m][0] = static_cast<std::uint16_t>(end0);
      own.end[m][1] = static_cast<std::uint16_t>(end1);
    }
  }
  const std::uint64_t now = cost_of(set);
  if (now > total && (now - total) * scale > kOwnRepeatsCost) own.distributions = kDistributions;
}

}  // namespace gicodec::native
