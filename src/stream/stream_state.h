// What a receiver of a stream holds: contents by number for each block, under the numbers of the
// packet that brought it there.
#pragma once

#include "base/memory.h"
#include "bitstream/packet.h"
#include "stream/block_history.h"

#include <cstdint>
#include <span>
#include <utility>

namespace gicodec {

/// Holds its blocks in the history for as long as it lives.
class StreamState {
 public:
  /// Nothing, before the first packet. `history` must outlive it.
  StreamState(BlockHistory& history, std::uint32_t blocks, PacketChain chain);
  StreamState(const StreamState& other);
  StreamState(StreamState&& other) noexcept = default;
  StreamState& operator=(StreamState other) noexcept;
  ~StreamState();

  /// What is held of each block.
  [[nodiscard]] std::span<const BlockId> blocks() const noexcept { return blocks_; }
  /// True if that belongs to the place where the block stood before.
  [[nodiscard]] bool moved(std::uint32_t block) const noexcept { return moved_[block] != 0; }
  [[nodiscard]] bool is(std::uint32_t sequence, std::uint32_t checksum) const noexcept {
    return chain.sequence == sequence && chain.checksum == checksum;
  }
  /// As Decoder::state_hash().
  [[nodiscard]] std::uint64_t hash() const;
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

  /// Other contents for a block, of where it now stands or where it `moved` from. Returns those
  /// before, which the caller has to release.
  [[nodiscard]] BlockId replace(std::uint32_t block, BlockId id, bool moved) noexcept {
    history_->hold(id);
    moved_[block] = moved ? 1 : 0;
    return std::exchange(blocks_[block], id);
  }
  /// These blocks stand elsewhere from now on.
  void set_moved(std::span<const std::uint32_t> blocks) noexcept;
  /// Nothing is held; the blocks stand where they stood.
  void clear() noexcept;

  PacketChain chain;

 private:
  BlockHistory* history_;
  Vector<BlockId> blocks_;
  Vector<std::uint8_t> moved_;
};

}  // namespace gicodec
