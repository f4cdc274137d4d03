#include "native/planes/tables.h"

#include "native/planes/table_data.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec::native {
namespace {

/// log2 in 1/256 bits, of 1..4096, negated and offset so that 4096 costs nothing.
constexpr std::array<std::uint16_t, kProbabilityScale + 1> make_costs() {
  std::array<std::uint16_t, kProbabilityScale + 1> cost{};
  cost[0] = 0xFFFF;
  for (std::uint32_t p = 1; p <= kProbabilityScale; ++p) {
    // Eight squarings give eight bits of the fraction.
    const int whole = 31 - std::countl_zero(p);
    std::uint64_t x = static_cast<std::uint64_t>(p) << (30 - whole);
    int fraction = 0;
    for (int i = 0; i < 8; ++i) {
      x = x * x >> 30;
      fraction *= 2;
      if (x >= std::uint64_t{1} << 31) {
        x >>= 1;
        ++fraction;
      }
    }
    cost[p] = static_cast<std::uint16_t>((12 - whole) * 256 - fraction);
  }
  return cost;
}
constexpr auto kCosts = make_costs();

struct Storage {
  RoleTables role[kRoles][kSets];
  RepeatTables repeats[2][kSets];
  Distribution distributions[kRoles][kSets][kDistributions];

  Storage() noexcept {
    const std::uint16_t* next = kTableNumbers;
    const auto byte = [&next] { return static_cast<std::uint8_t>(*next++); };
    for (unsigned role_number = 0; role_number < kRoles; ++role_number) {
      for (unsigned set = 0; set < kSets; ++set) {
        RoleTables& tables = role[role_number][set];
        for (unsigned m = 0; m < kDistributions; ++m) {
          Distribution& distribution = distributions[role_number][set][m];
          distribution.unit = byte();
          distribution.shift = byte();
          for (auto& units : distribution.units) units = byte();
          build_distribution(distribution, m, tables);
        }
        for (auto& m : tables.map) m = byte();
      }
    }
    for (auto& sets : repeats) {
      for (RepeatTables& tables : sets) {
        for (unsigned m = 0; m < kDistributions; ++m, next += 2)
          build_repeats(m, next[0], next[1], tables);
        for (auto& m : tables.map) m = byte();
      }
    }
  }
};
const Storage& storage() noexcept {
  static const Storage built;
  return built;
}

unsigned sum_of(const Distribution& distribution, unsigned symbols = kListed) {
  return std::accumulate(distribution.units, distribution.units + symbols, 0U);
}

std::uint32_t code_of_symbol(const Distribution& m, unsigned symbol) {
  const unsigned start = sum_of(m, symbol) << m.unit;
  const unsigned frequency = symbol == kZero ? kProbabilityScale - start
                                             : static_cast<unsigned>(m.units[symbol]) << m.unit;
  return start | frequency << 12 | raw_bits_of(symbol, m.shift) << 24;
}

}  // namespace

bool valid(const Distribution& distribution) noexcept {
  return distribution.unit <= kMaxUnit && distribution.shift <= kMaxShift &&
         distribution.units[kEscape] > 0 && sum_of(distribution) <= 255;
}

unsigned listed_symbols(const Distribution& distribution) noexcept {
  unsigned n = kEscape;
  while (n > 0 && distribution.units[n - 1] == 0) --n;
  return n;
}

std::uint32_t code_of(const Distribution& distribution, unsigned bin) noexcept {
  unsigned symbol = symbol_of(bin_begin(std::min(bin, kUsedBins - 1)) >> distribution.shift);
  if (symbol != kZero && distribution.units[symbol] == 0) symbol = kEscape;
  return code_of_symbol(distribution, symbol);
}

std::int16_t price_of(const Distribution& distribution, unsigned bin) noexcept {
  const std::uint32_t code = code_of(distribution, bin);
  return static_cast<std::int16_t>(kCosts[code >> 12 & 0xFFF] + 256 * (code >> 24));
}

void build_distribution(const Distribution& distribution, unsigned number,
                        RoleTables& out) noexcept {
  unsigned end = 0;
  std::uint8_t* const slots = out.symbol[number];
  for (unsigned s = 0; s < kListed; ++s) {
    std::fill_n(slots + end, distribution.units[s], static_cast<std::uint8_t>(s));
    end += distribution.units[s];
    (s % 4 == 3 ? out.quarter[s / 4][number] : out.inner[s % 4][s / 4 * kDistributions + number]) =
        static_cast<std::uint8_t>(end);
  }
  std::fill(slots + end, slots + 256, static_cast<std::uint8_t>(kZero));
  out.unit[number] = static_cast<std::uint8_t>(1U << distribution.unit);
  out.per16[number] = static_cast<std::uint8_t>(16U >> distribution.unit);
  out.shift[number] = distribution.shift;
  out.scale[number] = static_cast<std::uint8_t>(1U << distribution.shift);
  for (unsigned s = 0; s < kSymbols; ++s) {
    out.base[number][s] = static_cast<std::uint16_t>(kBase[s] << distribution.shift);
    out.by_symbol[number][s] = code_of_symbol(distribution, s);
  }
  for (unsigned b = 0; b < kBins; ++b) {
    out.by_bin[number][b] = code_of(distribution, b);
    out.price[number][b] = price_of(distribution, b);
  }
}

void build_repeats(unsigned distribution, std::uint16_t end0, std::uint16_t end1,
                   RepeatTables& out) noexcept {
  const std::uint16_t end[2] = {end0, end1};
  for (unsigned k = 0; k < 2; ++k) {
    out.low[k][distribution] = static_cast<std::uint8_t>(end[k]);
    out.high[k][distribution] = static_cast<std::uint8_t>(end[k] >> 8);
  }
}

const RoleTables& role_tables(unsigned role, unsigned set) noexcept {
  return storage().role[role][set];
}
const RepeatTables& repeat_tables(bool update, unsigned set) noexcept {
  return storage().repeats[update ? 1 : 0][set];
}
const Distribution& distribution_of(unsigned role, unsigned set, unsigned distribution) noexcept {
  return storage().distributions[role][set][distribution];
}

std::uint16_t frequency_cost(std::uint32_t frequency) noexcept { return kCosts[frequency]; }

}  // namespace gicodec::native
