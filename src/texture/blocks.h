// Blocks between a texture and block-linear memory: core texels block after block, row by row.
// strip() and reconstruct() are each other's inverse for textures whose guard bands follow the
// rule; gather_ring() and scatter_ring() carry those that do not (Stengel et al. §3.4, repacking).
#pragma once

#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include "texture/view.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Copies the core texels of `probes` to `cores` and appends to `stale` the places in `probes`
/// (0, 1, ...) whose guard band does not follow the rule.
void strip(Isa isa, const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> probes, std::span<std::byte> cores,
           std::vector<std::uint32_t>& stale);

/// Writes core texels and rule-given guard bands of `probes`.
void reconstruct(Isa isa, const TextureDesc& desc, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> probes, std::span<const std::byte> cores);

/// The guard band of one block as a ring (guard_band.h), and back.
void gather_ring(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t probe, std::span<std::byte> ring);
void scatter_ring(const TextureDesc& desc, const CheckedView<std::byte>& view, std::uint32_t probe,
                  std::span<const std::byte> ring);

}  // namespace gicodec
