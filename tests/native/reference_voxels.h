// Voxels of adaptive chunks for the reference decoder (docs/native.md, section 9.6).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

#include <vector>

namespace gicodec::reference {

[[nodiscard]] inline bool is_voxels(const TextureDesc& desc) {
  return desc.presence == Presence::brick && desc.prediction.relation == Relation::octree &&
         (desc.record.format == Format::E5B9G9R9_UFLOAT_PACK32 ||
          desc.record.format == Format::R16G16B16A16_SFLOAT);
}

/// The blocks' records by the model of voxels. `held`: by block, ascending.
[[nodiscard]] std::vector<std::vector<std::byte>> decode_voxels(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks,
    const std::vector<HeldBrick>& held, Learner& learner);

}  // namespace gicodec::reference
