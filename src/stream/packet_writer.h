// Writes the contents of some blocks as a packet.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/packet.h>

#include "base/memory.h"
#include "bitstream/packet.h"
#include "stream/block_history.h"
#include "stream/guard_band_section.h"
#include "texture/stale_bands.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Blocks of a stream, ascending, and the new contents of each.
struct Contents {
  Vector<std::uint32_t> blocks = {};
  Vector<BlockId> ids = {};

  void reserve(std::size_t size) {
    blocks.reserve(size);
    ids.reserve(size);
  }
  void clear() noexcept {
    blocks.clear();
    ids.clear();
  }
  void add(std::uint32_t block, BlockId id) {
    blocks.push_back(block);
    ids.push_back(id);
  }
};

/// Holds scratch memory; one per thread.
class PacketWriter {
 public:
  /// Replaces `out` by the packet for a receiver that holds `held`, a number per block. Of `head`,
  /// the caller sets backend, texture id, sequence, reference and type in `info`, and `base`.
  /// `decoded`: what a lossy backend made of the contents, block after block.
  Status write(const TextureDesc& desc, const BlockHistory& history, std::span<const BlockId> held,
               const Contents& contents, BackendEncoder& backend, PacketHead head, Packet& out,
               std::vector<std::byte>& decoded);

 private:
  std::vector<std::byte> index_, guard_bands_, payload_, presence_;
  StaleBands stale_, before_;
  GuardBandMemory band_memory_;
};

/// Upper bound of the bytes of a packet of that many blocks.
[[nodiscard]] std::size_t packet_bound(const TextureDesc& desc, const BackendEncoder& backend,
                                       std::size_t blocks) noexcept;

}  // namespace gicodec
