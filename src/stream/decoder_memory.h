// Peak memory of decoders and work of packets, in bytes, to compare with DecodeLimits.
#pragma once

#include <gicodec/inspect.h>
#include <gicodec/texture.h>

#include "native/models/models.h"
#include "native/planes/planes.h"
#include "texture/guard_band.h"
#include "texture/presence.h"

#include <algorithm>
#include <cstdint>

namespace gicodec {

/// Held by a decoder between packets: the mirror's records, bands and marks, and the list of
/// updated blocks.
[[nodiscard]] inline std::uint64_t held_memory(const TextureDesc& desc) noexcept {
  constexpr std::uint64_t kFixed = 1024, kBlock = 2 + 4;
  return kFixed +
         block_count(desc) * (block_bytes(desc) + band_bytes(desc) + kept_presence(desc) + kBlock);
}

/// Held by the scratch that decoders share, for the largest of their textures.
/// - Per block: the records of a packet; planes and reference of a byte backend; existing records,
///   unless all exist; bands before and after, and their blocks; lists of blocks, of which the
///   division into chunks takes five.
/// - Per thread: a native chunk's blocks and the mirror's as words, lanes, and adaptive models; for
///   continuous textures rasters.
/// - Bricks: lists by place, of the mirror's and of a chunk's.
[[nodiscard]] inline std::uint64_t scratch_memory(const TextureDesc& desc,
                                                  unsigned threads) noexcept {
  constexpr std::uint64_t kFixed = 256 << 10, kFixedOfThread = (9 << 18) + native::kModelMemory,
                          kBlock = 40;
  constexpr std::uint64_t kChunkBlocks = 4096;
  const std::uint64_t blocks = block_count(desc), block = block_bytes(desc);
  const std::uint64_t of_chunk =
      (4 * std::min(blocks, kChunkBlocks) + native::lane_blocks(desc)) * native::block_words(desc);
  const std::uint64_t presence = desc.presence == Presence::all ? 0 : block + presence_bytes(desc);
  const std::uint64_t places =
      kept_presence(desc) == 0 ? 0 : (1 + std::uint64_t{threads}) * sizeof(native::PlacedBrick);
  const std::uint64_t rasters = native::takes_raster(desc) ? native::raster_memory(desc) : 0;
  return kFixed + blocks * (places + 3 * block + presence + 2 * band_bytes(desc) + kBlock) +
         threads * (of_chunk + kFixedOfThread + rasters);
}

/// The work of a packet: bytes of the blocks that it writes or, as a keyframe, clears. Bricks add
/// the sorting of all bricks.
[[nodiscard]] inline std::uint64_t packet_work(const TextureDesc& desc,
                                               const PacketInfo& info) noexcept {
  const std::uint64_t all = block_count(desc);
  const std::uint64_t written = info.all_blocks ? all : std::min<std::uint64_t>(info.blocks, all);
  constexpr std::uint64_t kOrdering = 4;  // work of sorting, per byte of a brick's presence
  return (written + (is_keyframe(info.type) ? all : 0)) * (block_bytes(desc) + band_bytes(desc)) +
         all * kOrdering * kept_presence(desc);
}

}  // namespace gicodec
