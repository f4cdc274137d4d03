#pragma once

#include "native/frame/workspace.h"

namespace gicodec::native {

/// Checks what a chunk holds as far as that needs no probes. `scratch` is overwritten.
Status check_chunk(const TextureDesc& desc, const PlaneLayout& layout, bool update,
                   std::span<const std::byte> bytes, ChunkHead& scratch);
/// Decodes one chunk: the probes at `positions` of the update, into `texels` (the whole update's).
/// Adds to `statistics` if there are any. Safe on any bytes.
Status decode_chunk(const Update& u, std::span<const std::uint32_t> positions,
                    std::span<const std::byte> bytes, std::span<std::byte> texels, Workspace& w,
                    PayloadStatistics* statistics = nullptr);

}  // namespace gicodec::native
