// The state of a stream's receiver: a number of contents per block, and the sequence and checksum
// of the packet that led to it.
#pragma once

#include "base/memory.h"
#include "bitstream/packet.h"
#include "stream/block_history.h"

#include <cstdint>
#include <span>
#include <utility>

namespace gicodec {

/// Holds its contents in the history while it lives.
class StreamState {
 public:
  /// The state before the first packet: no block received. `history` must outlive it.
  StreamState(BlockHistory& history, std::uint32_t blocks, PacketChain chain);
  StreamState(const StreamState& other);
  StreamState(StreamState&& other) noexcept = default;
  StreamState& operator=(const StreamState&) = delete;
  ~StreamState();

  /// The contents of each block.
  [[nodiscard]] std::span<const BlockId> blocks() const noexcept { return blocks_; }
  /// True if the contents belong to the place where the block stood before set_moved().
  [[nodiscard]] bool moved(std::uint32_t block) const noexcept { return moved_[block] != 0; }
  [[nodiscard]] bool is(std::uint32_t sequence, std::uint32_t checksum) const noexcept {
    return chain.sequence == sequence && chain.checksum == checksum;
  }
  /// Equals Decoder::state_hash() of the receiver.
  [[nodiscard]] std::uint64_t hash() const;
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

  /// Sets the contents of a block, of its present place or, if `moved`, of its former one. Returns
  /// the previous contents, which the caller must release.
  [[nodiscard]] BlockId replace(std::uint32_t block, BlockId id, bool moved) noexcept {
    history_->hold(id);
    moved_[block] = moved ? 1 : 0;
    return std::exchange(blocks_[block], id);
  }
  /// Notes that these blocks stand elsewhere from now on.
  void set_moved(std::span<const std::uint32_t> blocks) noexcept;
  /// Releases all contents; moved() stays.
  void clear() noexcept;

  PacketChain chain;

 private:
  BlockHistory* history_;
  Vector<BlockId> blocks_;
  Vector<std::uint8_t> moved_;
};

}  // namespace gicodec
