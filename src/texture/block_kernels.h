// The loops behind strip and reconstruct (blocks.h): runs of square blocks ↔ records.
#pragma once

#include "simd/dispatch.h"

#include <cstddef>
#include <cstdint>

namespace gicodec {

/// Up to 64 square blocks at equal distances in a texture; a guard band is 0 or 1 record wide.
template <typename Byte>
struct BlockRun {
  Byte* first;  ///< first record of the first block, guard band included
  std::size_t row_pitch, step;
  unsigned count, core, guard_band, record_bytes;
};

/// Textures and records do not overlap.
struct BlockKernels {
  /// Copies the records of a run, block after block. Bit i of the result is set if the guard band
  /// of block i is irregular (octahedral_rule.h).
  std::uint64_t (*strip_run)(const BlockRun<const std::byte>& run, std::byte* cores);
  /// Writes records, and guard bands by the rule.
  void (*reconstruct_run)(const std::byte* cores, const BlockRun<std::byte>& run);
};

}  // namespace gicodec
