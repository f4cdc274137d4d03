// The tables: for every role and set the token distributions and the distribution of each context,
// and those of repeats (docs/native.md, "Tables"). Made by tools/train.
#pragma once

#include "native/planes/model.h"

#include <bit>
#include <cstdint>

namespace gicodec::native {

// Bins: values that every distribution distinguishes by raw bits alone.
inline constexpr unsigned kBins = 64;
constexpr unsigned bin_of(std::uint16_t value) {
  if (value < 8) return value;
  const auto top = static_cast<unsigned>(std::bit_width(value)) - 1;  // 3..15
  return 8 + 4 * (top - 3) + (value >> (top - 2) & 3U);
}
inline constexpr unsigned kUsedBins = bin_of(0xFFFF) + 1;
/// The least value of a bin below kUsedBins.
constexpr unsigned bin_begin(unsigned bin) {
  if (bin < 8) return bin;
  const unsigned octave = (bin - 8) / 4;
  return (4 + (bin & 3)) << (octave + 1);
}
static_assert(bin_of(8) == 8 && bin_of(10) == 9 && bin_begin(9) == 10 && bin_begin(12) == 16);
static_assert(kUsedBins <= kBins);
/// bin_of() of small values, which are most, without unpredictable branches.
struct SmallBins {
  std::uint8_t of[1024];
};
constexpr SmallBins make_small_bins() {
  SmallBins bins{};
  for (unsigned v = 0; v < 1024; ++v) {
    bins.of[v] = static_cast<std::uint8_t>(bin_of(static_cast<std::uint16_t>(v)));
  }
  return bins;
}
inline constexpr SmallBins kSmallBins = make_small_bins();
inline unsigned find_bin(std::uint16_t value) {
  return value < 1024 ? kSmallBins.of[value] : bin_of(value);
}
/// A distribution: units of 2^unit slots for the listed symbols, the rest for kZero.
struct Distribution {
  std::uint8_t unit, shift;
  std::uint8_t units[kListed];
};
/// Whether decoders accept it.
[[nodiscard]] bool valid(const Distribution& distribution) noexcept;
/// Symbols up to the last one before the escape that has units, which are those that heads list.
[[nodiscard]] unsigned listed_symbols(const Distribution& distribution) noexcept;
/// Code of values of a bin: start, frequency << 12, raw bits << 24.
[[nodiscard]] std::uint32_t code_of(const Distribution& distribution, unsigned bin) noexcept;
/// What they cost, raw bits included, in 1/256 bits.
[[nodiscard]] std::int16_t price_of(const Distribution& distribution, unsigned bin) noexcept;

/// A role's tables as coding needs them.
struct alignas(64) RoleTables {
  std::uint8_t map[kContexts];  ///< distribution by context
  // By distribution, for searches among the ends of symbols in units.
  std::uint8_t quarter[3][kDistributions];    ///< ends of symbols 3, 7, 11
  std::uint8_t inner[3][4 * kDistributions];  ///< [k][quarter·16 + distribution]: end of symbol
                                              ///< 4·quarter + k
  std::uint8_t unit[kDistributions];          ///< slots
  std::uint8_t per16[kDistributions];         ///< units in 16 slots
  std::uint8_t shift[kDistributions];
  std::uint8_t scale[kDistributions];        ///< 2^shift
  std::uint8_t symbol[kDistributions][256];  ///< by slot in units
  std::uint16_t base[kDistributions][kSymbols];
  /// By distribution and symbol, and by distribution and bin: start, frequency << 12, raw bits
  /// << 24. A bin whose symbol has no slots has those of the escape.
  std::uint32_t by_symbol[kDistributions][kSymbols];
  std::uint32_t by_bin[kDistributions][kBins];
  /// What values of a bin cost, raw bits included, in 1/256 bits.
  std::int16_t price[kDistributions][kBins];
};
/// Fills what follows from a distribution; the map is the caller's.
void build_distribution(const Distribution& distribution, unsigned number,
                        RoleTables& out) noexcept;

/// Distributions of repeat symbols.
struct alignas(64) RepeatTables {
  std::uint8_t map[kRepeatContexts];
  std::uint8_t low[2][kDistributions], high[2][kDistributions];  ///< bytes of end0 and end1
  [[nodiscard]] std::uint16_t end_of(unsigned which, unsigned distribution) const {
    return static_cast<std::uint16_t>(low[which][distribution] | high[which][distribution] << 8);
  }
  [[nodiscard]] std::uint32_t end(unsigned which, unsigned context) const {
    return end_of(which, map[context]);
  }
};
void build_repeats(unsigned distribution, std::uint16_t end0, std::uint16_t end1,
                   RepeatTables& out) noexcept;

/// Contexts of the repeats of rows.
inline constexpr unsigned kRowRepeatContexts = 180;
/// Distributions of repeat symbols of rows, which have more contexts.
struct alignas(64) RowRepeats {
  std::uint8_t map[256];
  std::uint8_t low[2][kDistributions], high[2][kDistributions];  ///< bytes of end0 and end1
  [[nodiscard]] std::uint32_t end(unsigned which, unsigned context) const {
    const unsigned distribution = map[context];
    return low[which][distribution] | static_cast<std::uint32_t>(high[which][distribution]) << 8;
  }
};

/// What a chunk is coded by.
struct Tables {
  const RoleTables* role[kPlaces];  ///< null where there is none
  const RepeatTables* repeats;
  const RowRepeats* rows;  ///< of row chunks, in place of `repeats`
};

/// Static tables. Built once, at first use; thread-safe.
const RoleTables& role_tables(unsigned role, unsigned set) noexcept;
const RepeatTables& repeat_tables(bool update, unsigned set) noexcept;
const Distribution& distribution_of(unsigned role, unsigned set, unsigned distribution) noexcept;

/// Cost of a symbol of that frequency (0..4096) in 1/256 bits.
std::uint16_t frequency_cost(std::uint32_t frequency) noexcept;

}  // namespace gicodec::native
