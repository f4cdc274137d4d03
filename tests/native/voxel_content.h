// Bricks of voxels for the native codec's tests.
#pragma once

#include "native/content.h"

namespace gicodec::test {

/// A pool of bricks of side 2, 4 or 8.
[[nodiscard]] TextureDesc voxels(std::uint32_t slots, std::uint8_t side, bool halves);

/// Bricks of two levels, and where they stand: the coarser voxels are the means of those under
/// them.
struct VoxelFrame {
  Bytes presence, records;  ///< of every slot
};
/// Most bricks stand where they stood a frame before, and most of their light is as it was.
[[nodiscard]] VoxelFrame make_voxels(const TextureDesc& desc, unsigned frame, std::uint64_t seed);

}  // namespace gicodec::test
