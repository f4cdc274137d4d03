// The guard band section of a packet: irregular bands, as differences to predicted bands
// (FORMAT.md, "Guard band section").
#pragma once

#include <gicodec/backend.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include "base/memory.h"
#include "stream/band_differences.h"
#include "texture/stale_bands.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// What both sides know before the section. The prediction of a band is the rule's band of the new
/// records in keyframes and intra updates, and the mirror's band in other updates.
struct GuardBandContext {
  const TextureDesc& desc;
  bool keyframe;  ///< or an intra update
  std::span<const std::uint32_t> blocks;
  BlockTable records;        ///< of `blocks`, as decoded
  BlockTable mirror;         ///< of all blocks, before the update
  const StaleBands& before;  ///< irregular bands of `blocks` before the update
  Threads threads = {};      ///< for resolve_guard_bands()
};

/// Upper bound of the section for `stale` bands in an update of `blocks` blocks.
[[nodiscard]] std::size_t guard_band_section_bound(const TextureDesc& desc, std::size_t blocks,
                                                   std::size_t stale) noexcept;

/// Scratch of the functions below, kept for its capacity.
struct GuardBandMemory {
  Vector<std::uint32_t> places = {};
  Vector<std::byte> bands = {};
  std::vector<std::byte> place_bytes = {}, packed = {};
  BandDifferences differences = {};
};

/// Appends the section for `stale`. Precondition: not empty, each block among context.blocks.
Status write_guard_band_section(const GuardBandContext& context, const StaleBands& stale,
                                GuardBandMemory& memory, std::vector<std::byte>& out);
/// Checks a section without the update's blocks. Time and memory are in proportion to it.
Status check_guard_band_section(const TextureDesc& desc, std::uint32_t blocks,
                                std::span<const std::byte> section) noexcept;
/// Reads the section of an update of these blocks. Accepts bands that turn out to be regular.
Status read_guard_band_section(const TextureDesc& desc, std::span<const std::uint32_t> update,
                               std::span<const std::byte> section, GuardBandMemory& memory,
                               StaleBands& differences);
/// Turns the differences into bands, after the records are decoded. Cannot fail.
void resolve_guard_bands(const GuardBandContext& context, StaleBands& bands) noexcept;

}  // namespace gicodec
