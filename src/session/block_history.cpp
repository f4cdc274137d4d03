#include "session/block_history.h"

#include "base/checksum.h"
#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>
#include <utility>

namespace gicodec {
BlockHistory::BlockHistory(const TextureDesc& desc, Isa isa)
    : desc_(desc),
      isa_(isa),
      core_bytes_(core_bytes(desc)),
      cores_(core_bytes_),
      digests_{checksum(cores_)},
      holders_{1 + probe_count(desc)},
      current_(probe_count(desc), kZeroBlock),
      probes_(probe_count(desc)),
      stripped_(probe_count(desc) * core_bytes_),
      ring_(ring_bytes(desc)) {
  std::iota(probes_.begin(), probes_.end(), 0U);
}

void BlockHistory::publish(const CheckedView<const std::byte>& view) {
  ++generation_;
  find_changes(view);
  collect();
  make_room(changed_.size());
  // From here on nothing can fail.
  for (const std::uint32_t probe : changed_) {
    const auto now = stripped(probe);
    auto ring = changed_rings_.extract(probe);
    BlockId block = kZeroBlock;
    if (!ring.empty() || std::memcmp(now.data(), core(kZeroBlock).data(), core_bytes_) != 0) {
      block = free_.back();
      free_.pop_back();
      std::memcpy(cores_.data() + block * core_bytes_, now.data(), core_bytes_);
      digests_[block] = checksum(now);
    }
    if (!ring.empty()) {
      ring.key() = block;
      stale_.insert(std::move(ring));
    }
    hold(block);
    release(std::exchange(current_[probe], block));
  }
}

/// The probes whose block is not the current one any more.
void BlockHistory::find_changes(const CheckedView<const std::byte>& view) {
  stale_places_.clear();
  changed_.clear();
  changed_rings_.clear();
  strip(isa_, desc_, view, probes_, stripped_, stale_places_);
  auto next_stale = stale_places_.begin();
  for (const std::uint32_t probe : probes_) {
    const bool stale = next_stale != stale_places_.end() && *next_stale == probe;
    if (stale) {
      ++next_stale;
      gather_ring(desc_, view, probe, ring_);
    }
    const BlockId before = current_[probe];
    const auto ring_before = stale_ring(before);
    const bool same_ring = stale ? std::ranges::equal(ring_before, ring_) : ring_before.empty();
    const auto now = stripped(probe);
    if (same_ring && std::memcmp(now.data(), core(before).data(), core_bytes_) == 0) continue;
    changed_.push_back(probe);
    if (stale) changed_rings_.emplace(probe, ring_);
  }
}

std::span<const std::byte> BlockHistory::stale_ring(BlockId id) const {
  if (stale_.empty()) return {};
  const auto it = stale_.find(id);
  return it == stale_.end() ? std::span<const std::byte>() : it->second;
}

bool BlockHistory::same_core(BlockId a, BlockId b) const noexcept {
  return digests_[a] == digests_[b] &&
         std::memcmp(core(a).data(), core(b).data(), core_bytes_) == 0;
}

/// As many free blocks, at least.
void BlockHistory::make_room(std::size_t blocks) {
  if (blocks <= free_.size()) return;
  const std::size_t before = holders_.size(), after = before + blocks - free_.size();
  free_.reserve(blocks);
  cores_.resize(after * core_bytes_);
  digests_.resize(after);
  holders_.resize(after);
  for (std::size_t id = before; id < after; ++id) free_.push_back(static_cast<BlockId>(id));
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
  free_.reserve(holders_.size());
  for (BlockId id = 0; id < holders_.size(); ++id) {
    if (holders_[id] > 0) continue;
    stale_.erase(id);
    free_.push_back(id);
  }
}

std::size_t BlockHistory::memory() const noexcept {
  return cores_.capacity() + (digests_.capacity() + holders_.capacity()) * sizeof(std::uint32_t) +
         free_.capacity() * sizeof(BlockId) + current_.capacity() * sizeof(BlockId) +
         probes_.capacity() * sizeof(std::uint32_t) + stripped_.capacity() +
         stale_.size() * (ring_bytes(desc_) + 64);
}

}  // namespace gicodec
