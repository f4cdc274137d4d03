#include "native/planes/distribution_fit.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>

namespace gicodec::native {
namespace {

constexpr unsigned kMaxUnits = 255;

constexpr auto kSymbolOfBin = [] {
  std::array<std::array<std::uint8_t, kUsedBins>, kMaxShift + 1> table{};
  for (unsigned shift = 0; shift <= kMaxShift; ++shift) {
    for (unsigned bin = 0; bin < kUsedBins; ++bin) {
      table[shift][bin] = static_cast<std::uint8_t>(symbol_of(bin_begin(bin) >> shift));
    }
  }
  return table;
}();

using Counts = std::array<std::uint64_t, kSymbols>;

/// Slots in proportion, as far as units and their number allow.
Distribution share(Counts counts, std::uint64_t total, unsigned shift, unsigned unit) {
  Distribution m{static_cast<std::uint8_t>(unit), static_cast<std::uint8_t>(shift), {}};
  // A symbol is worth its first unit if raw bits of escapes cost more than that takes from the
  // others, which is total · 2^unit / (4096 · ln 2) bits.
  constexpr std::uint64_t kUnitWorth = 2839;
  for (unsigned s = 0; s < kEscape; ++s) {
    if (counts[s] * (16 - raw_bits_of(s, shift)) * kUnitWorth > total << unit) {
      m.units[s] = 1;
    } else {
      counts[kEscape] += counts[s];
      counts[s] = 0;
    }
  }
  m.units[kEscape] = 1;
  const std::uint64_t listed = total - counts[kZero], in_all = kProbabilityScale >> unit;
  const std::uint64_t whole = std::max(total, (listed * in_all + kMaxUnits - 1) / kMaxUnits);
  const std::uint64_t scale = (in_all << 32) / whole;  // one division for all symbols
  unsigned sum = 0;
  for (unsigned s = 0; s < kListed; ++s) {
    const std::uint64_t units = (counts[s] * scale + (std::uint64_t{1} << 31)) >> 32;
    m.units[s] = static_cast<std::uint8_t>(std::max<std::uint64_t>(units, m.units[s]));
    sum += m.units[s];
  }
  for (; sum > kMaxUnits; --sum) --*std::max_element(std::begin(m.units), std::end(m.units));
  return m;
}

/// In 1/256 bits.
std::uint64_t cost(const Counts& counts, const Distribution& m) {
  const auto price = [&](unsigned s, unsigned slots) {
    return frequency_cost(slots) + 256 * raw_bits_of(s, m.shift);
  };
  const unsigned escape = price(kEscape, m.units[kEscape] << m.unit);
  const unsigned sum = std::accumulate(std::begin(m.units), std::end(m.units), 0U);
  std::uint64_t result = counts[kZero] * price(kZero, kProbabilityScale - (sum << m.unit));
  for (unsigned s = 0; s < kListed; ++s) {
    if (counts[s] == 0) continue;
    result += counts[s] * (m.units[s] == 0 ? escape : price(s, m.units[s] << m.unit));
  }
  return result;
}

}  // namespace

Distribution fit_distribution(const std::uint32_t (&counts)[kBins]) noexcept {
  Distribution best{};
  std::uint64_t least = UINT64_MAX;
  for (unsigned shift = 0; shift <= kMaxShift; ++shift) {
    Counts symbols{};
    for (unsigned bin = 0; bin < kUsedBins; ++bin) symbols[kSymbolOfBin[shift][bin]] += counts[bin];
    symbols[kZero] += 1;
    const auto total = std::accumulate(symbols.begin(), symbols.end(), std::uint64_t{0});
    // The finest unit that reaches, and its neighbours.
    const std::uint64_t listed = (total - symbols[kZero]) * kProbabilityScale;
    unsigned reaching = 0;
    while (reaching < kMaxUnit && listed > total * kMaxUnits << reaching) ++reaching;
    const unsigned coarsest = std::min(reaching + 1, kMaxUnit);
    for (unsigned unit = reaching - (reaching > 0); unit <= coarsest; ++unit) {
      const Distribution m = share(symbols, total, shift, unit);
      const std::uint64_t c = cost(symbols, m);
      if (c >= least) continue;
      least = c;
      best = m;
    }
  }
  return best;
}

}  // namespace gicodec::native
