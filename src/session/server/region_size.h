// How large the regions of a volume are where nobody says.
#pragma once

#include <gicodec/kind.h>

namespace gicodec {

/// 4×4×4 blocks, 8×8 of a flat grid, a run of a pool's slots: fewer where blocks are large, so that
/// the records of a region are 192 KiB at most, or one block. Precondition: validate(volume).
[[nodiscard]] Grid usual_region(const VolumeDesc& volume) noexcept;
/// `region`, or the usual one if it is all zeros.
[[nodiscard]] inline Grid region_for(const VolumeDesc& volume, const Grid& region) noexcept {
  return region == Grid{} ? usual_region(volume) : region;
}

}  // namespace gicodec
