// Voxels of adaptive chunks for the reference decoder (docs/native/octree.md).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

#include <vector>

namespace gicodec::reference {

/// Whether the voxel model is the texture's.
[[nodiscard]] bool is_voxels(const TextureDesc& desc);

/// The blocks' records by the voxel model. `held` is ascending.
[[nodiscard]] std::vector<std::vector<std::byte>> decode_voxels(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks,
    const std::vector<HeldBrick>& held, BitModels& models);

}  // namespace gicodec::reference
