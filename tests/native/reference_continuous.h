// Rasters of adaptive chunks for the reference decoder (docs/native/continuous.md).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

namespace gicodec::reference {

/// Whether adaptive chunks of the texture are rasters.
[[nodiscard]] bool is_raster(const TextureDesc& desc);
[[nodiscard]] bool may_be_rows(const TextureDesc& desc, const std::array<std::uint32_t, 3>& box);
[[nodiscard]] bool may_be_raster(const TextureDesc& desc, const std::array<std::uint32_t, 3>& box);
/// The blocks' records; nothing for a stream that breaks the format.
[[nodiscard]] std::vector<std::vector<std::byte>> decode_continuous(
    const TextureDesc& desc, const std::array<std::uint32_t, 3>& box,
    const std::vector<AdaptiveBlock>& blocks, const HeldBlocks& held, BitModels& models);

}  // namespace gicodec::reference
