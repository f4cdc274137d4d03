// Updates of bricks of voxels for the native codec's tests.
#pragma once

#include "native/content.h"
#include "native/vector_content.h"

namespace gicodec::test {

/// Surfaces under a few lamps with their coarser levels, whose light is the mean of that under
/// them; the same among bricks of any bytes and bricks at places that others have; any bytes.
enum class VoxelContent { octree, crowded, bits };
inline constexpr VoxelContent kVoxelContents[] = {VoxelContent::octree, VoxelContent::crowded,
                                                  VoxelContent::bits};

/// A pool of bricks of side³ voxels, 2, 4 or 8, of shared exponents or halves.
[[nodiscard]] TextureDesc voxels(std::uint32_t bricks, std::uint8_t side, bool halves);

struct BrickPool {
  Bytes presence, records;  ///< of every block
};
/// At frame 0, 1, ...: lamps move, surfaces come and go, bricks change their slots.
[[nodiscard]] BrickPool make_voxels(const TextureDesc& desc, VoxelContent content, unsigned frame,
                                    std::uint64_t seed);
/// As make_update().
[[nodiscard]] UpdateCase make_voxel_update(const TextureDesc& desc, VoxelContent content,
                                           UpdateMode mode, std::uint32_t one_in,
                                           std::uint64_t seed);

}  // namespace gicodec::test
