// Contents of some blocks → packet.
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

/// Blocks of a stream, ascending, and the contents that a receiver is to hold of them.
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

/// Holds the scratch memory of its calls; one per thread.
class PacketWriter {
 public:
  /// Replaces `out` by the packet for a receiver that holds `held` of each block. Of `head`, the
  /// caller sets backend, texture id, sequence, reference and type in `info`, and the base.
  /// `decoded`: what a lossy backend made of the contents, block after block.
  Status write(const TextureDesc& desc, const BlockHistory& history, std::span<const BlockId> held,
               const Contents& contents, BackendEncoder& backend, PacketHead head, Packet& out,
               std::vector<std::byte>& decoded);

 private:
  std::vector<std::byte> index_, guard_bands_, payload_, presence_;
  StaleBands stale_, before_;
  GuardBandMemory band_memory_;
};

/// Upper bound of a packet of that many blocks.
[[nodiscard]] std::size_t packet_bound(const TextureDesc& desc, const BackendEncoder& backend,
                                       std::size_t blocks) noexcept;

}  // namespace gicodec
