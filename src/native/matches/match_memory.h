// Memory of one thread for match chunks, kept for its capacity.
#pragma once

#include "base/memory.h"
#include "native/matches/bit_tree.h"

#include <cstdint>

namespace gicodec::native {

/// Literals, and the match behind them; at a distance of 0 it is of zeros.
struct Match {
  std::uint32_t length = 0, distance = 0;
};
struct MatchPart {
  std::uint32_t literals = 0;
  Match match;
};

struct MatchMemory {
  Vector<BitTree<8>> trees;
  /// Encoders: the bytes and those that no match has; places by hash, and for each that before it;
  /// how often bytes occur after others.
  Vector<std::uint8_t> bytes, literals;
  Vector<std::uint32_t> first, before, counts;
  Vector<MatchPart> parts;
};

}  // namespace gicodec::native
