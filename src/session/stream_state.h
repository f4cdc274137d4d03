// What a receiver of a stream holds: a block number per probe, under the numbers of the packet that
// brought it there.
#pragma once

#include "bitstream/packet.h"
#include "session/block_history.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Holds its blocks in the history for as long as it lives.
class StreamState {
 public:
  /// All zero, before the first packet. `history` must outlive it.
  StreamState(BlockHistory& history, std::uint32_t probes, PacketChain chain);
  StreamState(const StreamState& other);
  StreamState(StreamState&& other) noexcept = default;
  StreamState& operator=(StreamState other) noexcept;
  ~StreamState();

  [[nodiscard]] std::uint32_t probes() const noexcept {
    return static_cast<std::uint32_t>(blocks_.size());
  }
  [[nodiscard]] std::span<const BlockId> blocks() const noexcept { return blocks_; }
  /// True if the block belongs to the place where the probe stood before.
  [[nodiscard]] bool moved(std::uint32_t probe) const noexcept { return moved_[probe] != 0; }
  [[nodiscard]] bool is(std::uint32_t sequence, std::uint32_t checksum) const noexcept {
    return chain.sequence == sequence && chain.checksum == checksum;
  }
  /// As Decoder::state_hash().
  [[nodiscard]] std::uint64_t hash() const;
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

  /// Another block for a probe, where it now stands or where it `moved` from. Returns the one
  /// before, which the caller has to release.
  [[nodiscard]] BlockId replace(std::uint32_t probe, BlockId block, bool moved) noexcept;
  /// These probes stand elsewhere from now on.
  void set_moved(std::span<const std::uint32_t> probes) noexcept;
  /// All blocks are zero; the probes stand where they stood.
  void clear() noexcept;

  PacketChain chain;

 private:
  BlockHistory* history_;
  std::vector<BlockId> blocks_;
  std::vector<std::uint8_t> moved_;
};

}  // namespace gicodec
