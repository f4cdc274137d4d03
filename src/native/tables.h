// The tables: for every role and set a family of token distributions and the member of each
// context, and those of hits (docs/native.md, "Tables"). Made by tools/train.
#pragma once

#include "native/model.h"

#include <bit>
#include <cstdint>

namespace gicodec::native {

// Bins: values that no member tells apart but by raw bits.
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
/// bin_of() of small values, which are most, without branches that nobody can foresee.
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
struct Member {
  std::uint8_t unit, shift;
  std::uint8_t units[kListed];
};
/// Whether decoders accept it.
[[nodiscard]] bool valid(const Member& member) noexcept;
/// Symbols up to the last one before the escape that has units, which are those that heads list.
[[nodiscard]] unsigned listed_symbols(const Member& member) noexcept;
/// Code of values of a bin: start, frequency << 12, raw bits << 24.
[[nodiscard]] std::uint32_t code_of(const Member& member, unsigned bin) noexcept;
/// What they cost, raw bits included, in 1/256 bits.
[[nodiscard]] std::int16_t price_of(const Member& member, unsigned bin) noexcept;

/// A role's tables as coding needs them.
struct alignas(64) RoleTables {
  std::uint8_t map[kContexts];  ///< member by context
  // By member, for searches among the ends of symbols in units.
  std::uint8_t quarter[3][kMembers];    ///< ends of symbols 3, 7, 11
  std::uint8_t inner[3][4 * kMembers];  ///< [k][quarter·16 + member]: end of symbol 4·quarter + k
  std::uint8_t unit[kMembers];          ///< slots
  std::uint8_t per16[kMembers];         ///< units in 16 slots
  std::uint8_t shift[kMembers];
  std::uint8_t scale[kMembers];        ///< 2^shift
  std::uint8_t symbol[kMembers][256];  ///< by slot in units
  std::uint16_t base[kMembers][kSymbols];
  /// By member and symbol, and by member and bin: start, frequency << 12, raw bits << 24. A bin
  /// whose symbol has no slots has those of the escape.
  std::uint32_t by_symbol[kMembers][kSymbols];
  std::uint32_t by_bin[kMembers][kBins];
  /// What values of a bin cost, raw bits included, in 1/256 bits.
  std::int16_t price[kMembers][kBins];
};
/// Fills what follows from a member; the map is the caller's.
void build_member(const Member& member, unsigned number, RoleTables& out) noexcept;

/// Distributions of hit symbols.
struct alignas(64) HitTables {
  std::uint8_t map[kHitContexts];
  std::uint8_t low[2][kMembers], high[2][kMembers];  ///< bytes of end0 and end1
  [[nodiscard]] std::uint16_t end_of(unsigned which, unsigned member) const {
    return static_cast<std::uint16_t>(low[which][member] | high[which][member] << 8);
  }
  [[nodiscard]] std::uint32_t end(unsigned which, unsigned context) const {
    return end_of(which, map[context]);
  }
};
void build_hits(unsigned member, std::uint16_t end0, std::uint16_t end1, HitTables& out) noexcept;

/// What a chunk is coded by.
struct Tables {
  const RoleTables* role[kPlaces];  ///< null where there is none
  const HitTables* hits;
};

/// Static tables. Built once, at first use; thread-safe.
const RoleTables& role_tables(unsigned role, unsigned set) noexcept;
const HitTables& hit_tables(bool update, unsigned set) noexcept;
const Member& member_of(unsigned role, unsigned set, unsigned member) noexcept;

/// Cost of a symbol of that frequency (0..4096) in 1/256 bits.
std::uint16_t frequency_cost(std::uint32_t frequency) noexcept;

}  // namespace gicodec::native
