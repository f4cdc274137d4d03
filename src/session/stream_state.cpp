#include "session/stream_state.h"

#include "stream/state_hash.h"

#include <utility>

namespace gicodec {

StreamState::StreamState(BlockHistory& history, std::uint32_t probes, PacketChain chain_in)
    : chain(chain_in), history_(&history), blocks_(probes, kZeroBlock), moved_(probes) {
  for (const BlockId id : blocks_) history_->hold(id);
}

StreamState::StreamState(const StreamState& other)
    : chain(other.chain), history_(other.history_), blocks_(other.blocks_), moved_(other.moved_) {
  for (const BlockId id : blocks_) history_->hold(id);
}

StreamState& StreamState::operator=(StreamState other) noexcept {
  std::swap(chain, other.chain);
  std::swap(history_, other.history_);
  std::swap(blocks_, other.blocks_);
  std::swap(moved_, other.moved_);
  return *this;
}

StreamState::~StreamState() {
  for (const BlockId id : blocks_) history_->release(id);
}

std::uint64_t StreamState::hash() const {
  StateHash hash;
  for (std::uint32_t probe = 0; probe < blocks_.size(); ++probe) {
    hash.add(probe, history_->core(blocks_[probe]), history_->stale_ring(blocks_[probe]));
  }
  return hash.value();
}

std::size_t StreamState::memory() const noexcept {
  return blocks_.capacity() * sizeof(BlockId) + moved_.capacity();
}

BlockId StreamState::replace(std::uint32_t probe, BlockId block, bool moved) noexcept {
  history_->hold(block);
  moved_[probe] = moved ? 1 : 0;
  return std::exchange(blocks_[probe], block);
}

void StreamState::set_moved(std::span<const std::uint32_t> probes) noexcept {
  for (const std::uint32_t probe : probes) moved_[probe] = 1;
}

void StreamState::clear() noexcept {
  for (BlockId& id : blocks_) {
    history_->release(std::exchange(id, kZeroBlock));
    history_->hold(kZeroBlock);
  }
}

}  // namespace gicodec
