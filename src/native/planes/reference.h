// Reference blocks: what a mode predicts from, built block by block in the plane layout.
#pragma once

#include "native/planes/model.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// What is known about a block before it is coded; nullptr for what is not at hand. A neighbour
/// outside the update has its mirror value as current block.
struct Known {
  const std::uint16_t* previous = nullptr;
  const std::uint16_t* current[3] = {};  ///< of the neighbours at x−1, y−1, z−1
  const std::uint16_t* before[3] = {};   ///< their mirror values
};

/// The reference of `mode` for `count` values from offset `at` of the planes, either a block that
/// exists or `out`, filled. `constant` is the block for Reference::constant and ::frequent, and
/// where a mode finds neither previous values nor neighbours.
[[nodiscard]] const std::uint16_t* reference_block(const Mode& mode, const Known& known,
                                                   std::size_t at, std::size_t count,
                                                   const std::uint16_t* constant,
                                                   std::uint16_t* out) noexcept;
/// Whether the mode differs from others where neighbours are missing.
[[nodiscard]] bool usable(const Mode& mode, const Known& known) noexcept;

}  // namespace gicodec::native
