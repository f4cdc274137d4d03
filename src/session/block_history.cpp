#include "session/block_history.h"

#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <atomic>
#include <cstring>
#include <numeric>

namespace gicodec {

BlockHistory::BlockHistory(const TextureDesc& desc, Isa isa)
    : desc_(desc),
      isa_(isa),
      core_bytes_(core_bytes(desc)),
      cores_(core_bytes_),
      holders_{1 + probe_count(desc)},
      current_(probe_count(desc), kZeroBlock),
      probes_(probe_count(desc)),
      stripped_(probe_count(desc) * core_bytes_),
      ring_(ring_bytes(desc)) {
  std::iota(probes_.begin(), probes_.end(), 0U);
}

void BlockHistory::publish(const CheckedView<const std::byte>& view) {
  ++generation_;
  collect();
  stale_places_.clear();
  strip(isa_, desc_, view, probes_, stripped_, stale_places_);
  auto next_stale = stale_places_.begin();
  for (const std::uint32_t probe : probes_) {
    const auto now =
        std::span<const std::byte>(stripped_).subspan(probe * core_bytes_, core_bytes_);
    const bool stale = next_stale != stale_places_.end() && *next_stale == probe;
    if (stale) {
      ++next_stale;
      gather_ring(desc_, view, probe, ring_);
    }
    const BlockId before = current_[probe];
    const auto* ring_before = stale_ring(before);
    const bool same_ring =
        stale ? ring_before != nullptr && *ring_before == ring_ : ring_before == nullptr;
    if (same_ring && std::memcmp(now.data(), core(before).data(), core_bytes_) == 0) continue;
    const bool zero = !stale && std::memcmp(now.data(), core(kZeroBlock).data(), core_bytes_) == 0;
    const BlockId block = zero ? kZeroBlock : add(now);
    if (zero) hold(kZeroBlock);
    if (stale) stale_.emplace(block, ring_);
    current_[probe] = block;
    release(before);
  }
}

const std::vector<std::byte>* BlockHistory::stale_ring(BlockId id) const {
  if (stale_.empty()) return nullptr;
  const auto it = stale_.find(id);
  return it == stale_.end() ? nullptr : &it->second;
}

BlockId BlockHistory::add(std::span<const std::byte> core) {
  BlockId id = kZeroBlock;
  if (free_.empty()) {
    cores_.resize(cores_.size() + core_bytes_);
    id = static_cast<BlockId>(holders_.size());
    holders_.push_back(0);
  } else {
    id = free_.back();
    free_.pop_back();
  }
  std::memcpy(cores_.data() + id * core_bytes_, core.data(), core_bytes_);
  holders_[id] = 1;
  return id;
}

void BlockHistory::hold(BlockId id) noexcept {
  std::atomic_ref(holders_[id]).fetch_add(1, std::memory_order_relaxed);
}

void BlockHistory::release(BlockId id) noexcept {
  std::atomic_ref(holders_[id]).fetch_sub(1, std::memory_order_acq_rel);
}

/// Blocks without a holder become free. Done here and not in release(), which may run beside
/// others.
void BlockHistory::collect() {
  free_.clear();
  for (BlockId id = 0; id < holders_.size(); ++id) {
    if (holders_[id] > 0) continue;
    stale_.erase(id);
    free_.push_back(id);
  }
}

std::size_t BlockHistory::memory() const noexcept {
  return cores_.capacity() + holders_.capacity() * sizeof(std::uint32_t) +
         free_.capacity() * sizeof(BlockId) + current_.capacity() * sizeof(BlockId) +
         probes_.capacity() * sizeof(std::uint32_t) + stripped_.capacity() +
         stale_.size() * (ring_bytes(desc_) + 64);
}

}  // namespace gicodec
