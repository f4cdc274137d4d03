// What decoders hold at their worst and what packets have them do, in bytes: what limits are
// compared with.
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

/// By a decoder between two packets: the mirror's records, bands and marks, and the blocks updated.
[[nodiscard]] inline std::uint64_t held_memory(const TextureDesc& desc) noexcept {
  constexpr std::uint64_t kFixed = 1024, kBlock = 2 + 4;
  return kFixed +
         block_count(desc) * (block_bytes(desc) + band_bytes(desc) + kept_presence(desc) + kBlock);
}

/// By the scratch that decoders share, for the largest of their textures. Per block: the records
/// of a packet, planes and reference of a byte backend, and the records that exist where not all
/// do; bands, those before, and their blocks; lists of blocks, of which cutting chunks takes five.
/// Per thread: a native chunk's blocks and the mirror's as words, lanes, and adaptive models.
/// Bricks are listed by their places: those of the mirror, and those of a chunk.
[[nodiscard]] inline std::uint64_t scratch_memory(const TextureDesc& desc,
                                                  unsigned threads) noexcept {
  constexpr std::uint64_t kFixed = 256 << 10, kFixedOfThread = (2 << 20) + native::kModelMemory,
                          kBlock = 40;
  constexpr std::uint64_t kChunkBlocks = 4096;
  const std::uint64_t blocks = block_count(desc), block = block_bytes(desc);
  const std::uint64_t of_chunk =
      (4 * std::min(blocks, kChunkBlocks) + native::lane_blocks(desc)) * native::block_words(desc);
  const std::uint64_t presence = desc.presence == Presence::all ? 0 : block + presence_bytes(desc);
  const std::uint64_t places =
      kept_presence(desc) == 0 ? 0 : (1 + std::uint64_t{threads}) * sizeof(native::PlacedBrick);
  return kFixed + blocks * (places + 3 * block + presence + 2 * band_bytes(desc) + kBlock) +
         threads * (of_chunk + kFixedOfThread);
}

/// Work: the blocks that a packet writes or, as a keyframe, clears; bricks are all put in order.
[[nodiscard]] inline std::uint64_t packet_work(const TextureDesc& desc,
                                               const PacketInfo& info) noexcept {
  const std::uint64_t all = block_count(desc);
  const std::uint64_t written = info.all_blocks ? all : std::min<std::uint64_t>(info.blocks, all);
  constexpr std::uint64_t kOrdering = 4;  // times what is known of a brick
  return (written + (is_keyframe(info.type) ? all : 0)) * (block_bytes(desc) + band_bytes(desc)) +
         all * kOrdering * kept_presence(desc);
}

}  // namespace gicodec
