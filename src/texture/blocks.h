// Blocks between a texture and block-linear memory, which holds records block after block, along x,
// then y, then z. strip() and reconstruct() are inverses for textures with regular guard bands;
// gather_band() and scatter_band() carry irregular ones (Stengel et al. §3.4, repacking).
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

/// Blocks that take longer to copy than a thread to start: for_each_range()'s `minimum`.
[[nodiscard]] inline std::size_t blocks_per_thread(const TextureDesc& desc) noexcept {
  constexpr std::size_t kBytesPerThread = 2 << 20;
  return std::max<std::size_t>(kBytesPerThread / block_bytes(desc), 1);
}

/// Copies the records of `blocks`; those beyond the texture become zeros. Appends to `stale` the
/// indices in `blocks` (0, 1, …) whose guard band is irregular.
void strip(Isa isa, const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> blocks, std::span<std::byte> records,
           Vector<std::uint32_t>& stale);

/// Writes the records of `blocks`, and their guard bands by the rule.
void reconstruct(Isa isa, const TextureDesc& desc, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> blocks, std::span<const std::byte> records);

/// The guard band of one block ↔ a band (guard_band.h).
void gather_band(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t block, std::span<std::byte> band);
void scatter_band(const TextureDesc& desc, const CheckedView<std::byte>& view, std::uint32_t block,
                  std::span<const std::byte> band);

}  // namespace gicodec
