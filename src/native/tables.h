// The static tables: a family of token distributions, and for every context of every set the
// member it uses (docs/native.md, "Tables"). The data is made by tools/train.
#pragma once

#include "native/kernels.h"

#include <cstdint>

namespace gicodec::native {

struct TableData {
  std::uint16_t frequency[kDistributions][kTokens];  ///< 1..4095 each, 4096 in all
  const char* map[kSets][kRows];  ///< kSignClasses × kMagnitudes base-64 digits per row
  /// Ends of hit symbols 0 and 1, ascending within 1..4095: [set][update][symbol][context].
  std::uint16_t hits[kSets][2][2][kHitContexts];
};
extern const TableData kTableData;

/// Tables of a set for keyframes or updates. Built once, at first use; thread-safe.
const Tables& tables(unsigned set, bool update) noexcept;
/// Frequencies of the tokens, ready for coding.
void build_distribution(const std::uint16_t* frequency, Distribution& out) noexcept;
/// Cost of a symbol of that frequency (0..4096) in 1/256 bits.
std::uint16_t frequency_cost(std::uint32_t frequency) noexcept;

}  // namespace gicodec::native
