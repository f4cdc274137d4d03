// The guard band section of a packet: bands that do not follow the rule, as differences to the
// bands that the decoder would otherwise have (FORMAT.md, "Guard band section").
#pragma once

#include <gicodec/backend.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include "backend/compressor.h"
#include "base/memory.h"
#include "texture/stale_bands.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec {

/// What both sides know before the section: in keyframes and intra updates a band is predicted by
/// the rule from the new records, in other updates by the mirror.
struct GuardBandContext {
  const TextureDesc& desc;
  bool keyframe;  ///< or an intra update
  std::span<const std::uint32_t> blocks;
  BlockTable records;        ///< of `blocks`, as decoded
  BlockTable mirror;         ///< of every block, before the update
  const StaleBands& before;  ///< of those of `blocks` that had one
  Threads threads = {};      ///< of resolve_guard_bands()
};

/// Upper bound of the section for `stale` bands in an update of `blocks` blocks.
[[nodiscard]] std::size_t guard_band_section_bound(const TextureDesc& desc, std::size_t blocks,
                                                   std::size_t stale) noexcept;

/// What the functions below need, kept for its capacity.
struct GuardBandMemory {
  Vector<std::uint32_t> places = {};
  Vector<std::byte> bands = {};
  std::vector<std::byte> place_bytes = {}, packed = {};
  std::optional<Compressor> compressor = {};
  std::optional<Decompressor> decompressor = {};
};

/// Appends the section for `stale` (probe → band; not empty, each among context.blocks).
Status write_guard_band_section(const GuardBandContext& context, const StaleBands& stale,
                                GuardBandMemory& memory, std::vector<std::byte>& out);
/// What can be told of a section without the blocks of its update, in time and memory of its size.
Status check_guard_band_section(const TextureDesc& desc, std::uint32_t blocks,
                                std::span<const std::byte> section) noexcept;
/// Fills `differences` for an update of these blocks. Bands that turn out to follow the rule are
/// accepted.
Status read_guard_band_section(const TextureDesc& desc, std::span<const std::uint32_t> update,
                               std::span<const std::byte> section, GuardBandMemory& memory,
                               StaleBands& differences);
/// Turns the differences into bands, once the records are there. Cannot fail.
void resolve_guard_bands(const GuardBandContext& context, StaleBands& bands) noexcept;

}  // namespace gicodec
