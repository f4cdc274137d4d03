// Prediction and contexts of the reference decoder (docs/native.md, sections 6 and 7).
#pragma once

#include "native/reference_entropy.h"

#include <array>
#include <optional>
#include <vector>

namespace gicodec::reference {

using Values = std::vector<std::vector<int>>;  ///< [plane][texel]

struct Head {
  bool update = false;
  unsigned columns = 0, rows = 0;  ///< rows of all slices
  std::vector<unsigned> bits;
  std::vector<bool> low;
  bool mantissas = false;  ///< all planes but the last, their exponent
  bool repeats = false;
  /// 0, 1 or 2: which of the chunk's families a plane has.
  [[nodiscard]] std::size_t place(std::size_t plane) const;
  std::vector<bool> coded;
  std::vector<int> constant;
  std::array<int, 2> frequent{};
  Tables tables;
};

/// Which records of a block exist, and what is known of it and its neighbours X, Y, Z before it is
/// decoded.
struct Surroundings {
  std::vector<bool> exists;
  std::optional<Values> previous, now[3], before[3];
};

/// One group; blocks in lanes.
[[nodiscard]] std::optional<std::vector<Values>> decode_planes(
    const Head& head, const std::vector<Surroundings>& blocks, Lanes& coder);
[[nodiscard]] std::optional<std::vector<Values>> decode_pairs(
    const Head& head, const std::vector<Surroundings>& blocks, Lanes& coder);

}  // namespace gicodec::reference
