// Vectors of adaptive chunks for the reference decoder (docs/native/hemispheres.md).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

#include <vector>

namespace gicodec::reference {

/// The blocks' records by the vector model.
[[nodiscard]] std::vector<std::vector<std::byte>> decode_vectors(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held,
    BitModels& models);

}  // namespace gicodec::reference
