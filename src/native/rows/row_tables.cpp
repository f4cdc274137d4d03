#include "native/rows/row_tables.h"

#include "native/frame/chunk_head.h"
#include "native/planes/distribution_fit.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace gicodec::native {
namespace {

constexpr int kRounds = 3;
/// Symbols that are worth another distribution.
constexpr std::uint64_t kWorth = 1024, kWorthOfRepeats = 1024;

unsigned bits_of_map(unsigned count) {
  return count <= 1 ? 0 : static_cast<unsigned>(std::bit_width(count - 1));
}

/// Entries of `bits` bits, lowest first, filled up to whole bytes.
void write_map(std::span<const std::uint8_t> map, unsigned bits, ByteWriter& writer) {
  std::uint32_t held = 0;
  unsigned count = 0;
  for (const std::uint8_t entry : map) {
    held |= static_cast<std::uint32_t>(entry) << count;
    for (count += bits; count >= 8; count -= 8, held >>= 8) {
      writer.fixed(static_cast<std::uint8_t>(held));
    }
  }
  if (count > 0) writer.fixed(static_cast<std::uint8_t>(held));
}
void read_map(ByteReader& reader, unsigned bits, unsigned most, std::span<std::uint8_t> map) {
  std::uint32_t held = 0;
  unsigned count = 0;
  for (std::uint8_t& entry : map) {
    if (count < bits) {
      held |= static_cast<std::uint32_t>(reader.fixed<std::uint8_t>()) << count;
      count += 8;
    }
    entry = static_cast<std::uint8_t>(held & ((1U << bits) - 1));
    held >>= bits;
    count -= bits;
    if (entry >= most) return reader.fail(Status::corrupt);
  }
  if (held != 0) reader.fail(Status::corrupt);
}

/// As many as are worth it, one for the map's sake where few symbols are.
unsigned distributions_for(std::uint64_t symbols, std::uint64_t worth) {
  return static_cast<unsigned>(
      std::clamp<std::uint64_t>(std::bit_floor(symbols / worth), 1, kDistributions));
}

/// Gives contexts, in ascending order of `key`, to as many owners, of like numbers of symbols.
template <typename Symbols>
void deal(Vector<std::pair<std::uint64_t, std::uint8_t>>& order, std::uint64_t all, unsigned owners,
          const Symbols& symbols, std::span<std::uint8_t> owner) {
  std::sort(order.begin(), order.end());
  std::uint64_t before = 0;
  for (const auto& [key, context] : order) {
    owner[context] =
        static_cast<std::uint8_t>(std::min<std::uint64_t>(owners - 1, before * owners / all));
    before += symbols(context);
  }
}

}  // namespace

void RowTables::count(std::span<const Step> steps) {
  bins_.assign(std::size_t{kRowRoles} * kContexts, Bins{});
  repeat_counts_ = {};
  for (const Step& step : steps) {
    for (std::uint32_t rest = step.active; rest != 0; rest &= rest - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(rest));
      if (step.repeat != 0) {
        ++repeat_counts_.data()[step.context[l]].data()[step.value[l]];
      } else {
        const std::size_t at = step.place * std::size_t{kContexts} + step.context[l];
        ++bins_.data()[at].data()[find_bin(step.value[l])];
      }
    }
  }
}

void RowTables::fit_role(unsigned role, unsigned contexts) {
  const Bins* const bins = bins_.data() + std::size_t{role} * kContexts;
  std::span<std::uint8_t> map(map_[role]);
  std::fill(std::begin(map), std::end(map), std::uint8_t{0});
  Role& fitted = role_[role];
  std::array<std::uint64_t, kContexts> seen{};
  Vector<std::pair<std::uint64_t, std::uint8_t>> order;
  std::uint64_t all = 0;
  for (unsigned c = 0; c < contexts; ++c) {
    std::uint64_t sum = 0;
    for (unsigned b = 0; b < kUsedBins; ++b) {
      seen[c] += bins[c][b];
      sum += bins[c][b] * std::uint64_t{b};
    }
    if (seen[c] == 0) continue;
    all += seen[c];
    order.emplace_back((sum << 16) / seen[c], static_cast<std::uint8_t>(c));
  }
  fitted.count = distributions_for(all, kWorth);
  if (order.empty()) {
    fitted.distribution[0] = {};
    fitted.distribution[0].units[kEscape] = 1;
    return;
  }
  deal(
      order, all, fitted.count, [&](std::uint8_t c) { return seen[c]; }, map);
  std::array<std::array<std::uint32_t, kBins>, kDistributions> price{};
  for (int round = 0;; ++round) {
    for (unsigned m = 0; m < fitted.count; ++m) {
      std::uint32_t pooled[kBins] = {};
      for (const auto& [key, c] : order) {
        if (map[c] != m) continue;
        for (unsigned b = 0; b < kUsedBins; ++b) pooled[b] += bins[c][b];
      }
      fitted.distribution[m] = fit_distribution(pooled);
      for (unsigned b = 0; b < kUsedBins; ++b) {
        price[m][b] = static_cast<std::uint16_t>(price_of(fitted.distribution[m], b));
      }
    }
    if (round == kRounds) return;
    for (const auto& [key, c] : order) {
      std::uint64_t least = UINT64_MAX;
      for (unsigned m = 0; m < fitted.count; ++m) {
        std::uint64_t cost = 0;
        for (unsigned b = 0; b < kUsedBins; ++b) cost += std::uint64_t{bins[c][b]} * price[m][b];
        if (cost >= least) continue;
        least = cost;
        map[c] = static_cast<std::uint8_t>(m);
      }
    }
  }
}

void RowTables::fit_repeats() {
  std::fill(std::begin(repeat_map_), std::end(repeat_map_), std::uint8_t{0});
  Vector<std::pair<std::uint64_t, std::uint8_t>> order;
  std::uint64_t all = 0;
  const auto seen = [&](std::uint8_t c) {
    const RepeatCounts& n = repeat_counts_[c];
    return std::uint64_t{n[0]} + n[1] + n[2];
  };
  for (unsigned c = 0; c < kRowRepeatContexts; ++c) {
    const std::uint64_t sum = seen(static_cast<std::uint8_t>(c));
    if (sum == 0) continue;
    all += sum;
    order.emplace_back((std::uint64_t{repeat_counts_[c][2]} << 16) / sum,
                       static_cast<std::uint8_t>(c));
  }
  repeats_ = distributions_for(all, kWorthOfRepeats);
  end_[0] = {1365, 2730};
  if (order.empty()) return;
  deal(order, all, repeats_, seen, repeat_map_);
  for (int round = 0;; ++round) {
    std::array<RepeatCounts, kDistributions> pooled{};
    for (const auto& [key, c] : order) {
      for (unsigned s = 0; s < 3; ++s) pooled[repeat_map_[c]][s] += repeat_counts_[c][s];
    }
    for (unsigned m = 0; m < repeats_; ++m) {
      const auto& n = pooled[m];
      const std::uint64_t sum = std::uint64_t{n[0]} + n[1] + n[2] + 1;
      const auto share = [&](std::uint64_t part) {
        return static_cast<std::uint32_t>((part * kProbabilityScale + sum / 2) / sum);
      };
      const std::uint32_t end0 = std::clamp(share(n[0]), 1U, kProbabilityScale - 2);
      const std::uint32_t end1 =
          std::clamp(share(std::uint64_t{n[0]} + n[1]), end0 + 1, kProbabilityScale - 1);
      end_[m] = {static_cast<std::uint16_t>(end0), static_cast<std::uint16_t>(end1)};
    }
    if (round == kRounds) return;
    for (const auto& [key, c] : order) {
      std::uint64_t least = UINT64_MAX;
      const auto& n = repeat_counts_[c];
      for (unsigned m = 0; m < repeats_; ++m) {
        const std::uint32_t end0 = end_[m][0], end1 = end_[m][1];
        const std::uint64_t cost = std::uint64_t{n[0]} * frequency_cost(end0) +
                                   std::uint64_t{n[1]} * frequency_cost(end1 - end0) +
                                   std::uint64_t{n[2]} * frequency_cost(kProbabilityScale - end1);
        if (cost >= least) continue;
        least = cost;
        repeat_map_[c] = static_cast<std::uint8_t>(m);
      }
    }
  }
}

void RowTables::fit(std::span<const Step> steps, const RowClasses& classes) {
  count(steps);
  fit_repeats();
  for (unsigned r = 0; r < kRowRoles; ++r) {
    if (classes[r] > 0) fit_role(r, classes[r] * kRowClass);
  }
  build(classes);
}

void RowTables::write(const RowClasses& classes, ByteWriter& writer) const {
  writer.fixed(static_cast<std::uint8_t>(repeats_));
  for (unsigned m = 0; m < repeats_; ++m) {
    for (const std::uint16_t end : end_[m]) writer.fixed(end);
  }
  write_map(std::span(repeat_map_).first(kRowRepeatContexts), bits_of_map(repeats_), writer);
  for (unsigned r = 0; r < kRowRoles; ++r) {
    if (classes[r] == 0) continue;
    const Role& role = role_[r];
    writer.fixed(static_cast<std::uint8_t>(role.count));
    for (unsigned m = 0; m < role.count; ++m) write_distribution(role.distribution[m], writer);
    write_map(std::span(map_[r]).first(classes[r] * std::size_t{kRowClass}),
              bits_of_map(role.count), writer);
  }
}

void RowTables::read(const RowClasses& classes, ByteReader& reader) {
  repeats_ = reader.fixed<std::uint8_t>();
  if (repeats_ < 1 || repeats_ > kDistributions) return reader.fail(Status::corrupt);
  for (unsigned m = 0; m < repeats_; ++m) {
    for (auto& end : end_[m]) end = reader.fixed<std::uint16_t>();
    if (end_[m][0] == 0 || end_[m][0] >= end_[m][1] || end_[m][1] >= kProbabilityScale) {
      return reader.fail(Status::corrupt);
    }
  }
  std::fill(std::begin(repeat_map_), std::end(repeat_map_), std::uint8_t{0});
  read_map(reader, bits_of_map(repeats_), repeats_,
           std::span(repeat_map_).first(kRowRepeatContexts));
  for (unsigned r = 0; r < kRowRoles && reader.ok(); ++r) {
    if (classes[r] == 0) continue;
    Role& role = role_[r];
    role.count = reader.fixed<std::uint8_t>();
    if (role.count < 1 || role.count > kDistributions) return reader.fail(Status::corrupt);
    for (unsigned m = 0; m < role.count && reader.ok(); ++m) {
      read_distribution(reader, role.distribution[m]);
    }
    std::fill(std::begin(map_[r]), std::end(map_[r]), std::uint8_t{0});
    read_map(reader, bits_of_map(role.count), role.count,
             std::span(map_[r]).first(classes[r] * std::size_t{kRowClass}));
  }
  if (reader.ok()) build(classes);
}

void RowTables::build(const RowClasses& classes) {
  built_.resize(kRowRoles);
  for (unsigned r = 0; r < kRowRoles; ++r) {
    tables_.role[r] = &built_[r];
    if (classes[r] == 0) continue;
    for (unsigned m = 0; m < role_[r].count; ++m) {
      build_distribution(role_[r].distribution[m], m, built_[r]);
    }
    std::copy(std::begin(map_[r]), std::end(map_[r]), std::begin(built_[r].map));
  }
  for (unsigned m = 0; m < repeats_; ++m) {
    for (unsigned k = 0; k < 2; ++k) {
      built_repeats_.low[k][m] = static_cast<std::uint8_t>(end_[m][k]);
      built_repeats_.high[k][m] = static_cast<std::uint8_t>(end_[m][k] >> 8);
    }
  }
  std::copy(std::begin(repeat_map_), std::end(repeat_map_), std::begin(built_repeats_.map));
  tables_.rows = &built_repeats_;
}

}  // namespace gicodec::native
