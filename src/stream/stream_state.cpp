#include "stream/stream_state.h"

#include "stream/state_hash.h"

#include <utility>

namespace gicodec {

StreamState::StreamState(BlockHistory& history, std::uint32_t blocks, PacketChain chain_in)
    : chain(chain_in), history_(&history), blocks_(blocks, kNothing), moved_(blocks) {
  for (const BlockId id : blocks_) history_->hold(id);
}

StreamState::StreamState(const StreamState& other)
    : chain(other.chain), history_(other.history_), blocks_(other.blocks_), moved_(other.moved_) {
  for (const BlockId id : blocks_) history_->hold(id);
}

StreamState::~StreamState() {
  for (const BlockId id : blocks_) history_->release(id);
}

std::uint64_t StreamState::hash() const {
  StateHash hash;
  for (std::uint32_t block = 0; block < blocks_.size(); ++block) {
    const BlockId id = blocks_[block];
    if (id != kNothing) hash.add(block, history_->records(id), history_->stale_band(id));
  }
  return hash.value();
}

std::size_t StreamState::memory() const noexcept {
  return blocks_.capacity() * sizeof(BlockId) + moved_.capacity();
}

void StreamState::set_moved(std::span<const std::uint32_t> blocks) noexcept {
  for (const std::uint32_t block : blocks) moved_[block] = 1;
}

void StreamState::clear() noexcept {
  for (BlockId& id : blocks_) {
    history_->release(std::exchange(id, kNothing));
    history_->hold(kNothing);
  }
}

}  // namespace gicodec
