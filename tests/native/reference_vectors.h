// Vectors of adaptive chunks for the reference decoder (docs/native.md, section 9.5).
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
