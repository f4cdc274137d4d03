// Blocks between a texture and block-linear memory: records block after block, along x, then y,
// then z. strip() and reconstruct() are each other's inverse for textures whose guard bands follow
// the rule; gather_band() and scatter_band() carry those that do not (Stengel et al. §3.4,
// repacking).
#pragma once

#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include "base/memory.h"
#include "texture/view.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Blocks whose way from or to memory takes longer than starting a thread (for_each_range()).
[[nodiscard]] inline std::size_t blocks_per_thread(const TextureDesc& desc) noexcept {
  constexpr std::size_t kBytesPerThread = 2 << 20;
  return std::max<std::size_t>(kBytesPerThread / block_bytes(desc), 1);
}

/// Copies the records of `blocks`, those outside the volume as zeros, and appends to `stale` the
/// places in `blocks` (0, 1, ...) whose guard band does not follow the rule.
void strip(Isa isa, const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> blocks, std::span<std::byte> records,
           Vector<std::uint32_t>& stale);

/// Writes records and rule-given guard bands of `blocks`.
void reconstruct(Isa isa, const TextureDesc& desc, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> blocks, std::span<const std::byte> records);

/// The guard band of one block as a band (guard_band.h), and back.
void gather_band(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t block, std::span<std::byte> band);
void scatter_band(const TextureDesc& desc, const CheckedView<std::byte>& view, std::uint32_t block,
                  std::span<const std::byte> band);

}  // namespace gicodec
