// Memory of one thread for match chunks, kept for its capacity.
#pragma once

#include "native/matches/bit_tree.h"

#include <cstdint>
#include <vector>

namespace gicodec::native {

/// Literals, and the match behind them. The last one may have none.
struct Match {
  std::uint32_t length = 0, distance = 0;
};
struct MatchPart {
  std::uint32_t literals = 0;
  Match match;
};

struct MatchMemory {
  std::vector<BitTree<8>> trees;
  /// Encoders: the bytes and those that no match has; places by hash, and for each that before it;
  /// how often bytes occur after others.
  std::vector<std::uint8_t> bytes, literals;
  std::vector<std::uint32_t> first, before, counts;
  std::vector<MatchPart> parts;
};

}  // namespace gicodec::native
