#include "stream/block_history.h"

#include "base/checksum.h"
#include "texture/blocks.h"
#include "texture/guard_band.h"
#include "texture/presence.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <utility>

namespace gicodec {

BlockHistory::BlockHistory(const TextureDesc& desc, Isa isa, Use use)
    : desc_(desc),
      isa_(isa),
      use_(use),
      block_bytes_(block_bytes(desc)),
      presence_bytes_(presence_bytes(desc)),
      records_(2 * block_bytes_),
      presence_(2 * presence_bytes_),
      digests_(use == Use::server ? 2 : 0, checksum(records(kNothing))),
      holders_{1 + block_count(desc), 1},
      current_(block_count(desc), kNothing),
      band_(band_bytes(desc)) {}

void BlockHistory::publish(const CheckedView<const std::byte>& view,
                           std::span<const std::uint32_t> blocks,
                           std::span<const std::byte> presence) {
  find_changes(view, blocks, presence);
  make_room(changed_.size());
  // From here on nothing can fail.
  for (const std::uint32_t place : changed_) {
    const std::uint32_t block = blocks[place];
    const std::byte* const now = stripped_.data() + std::size_t{place} * block_bytes_;
    auto band = changed_bands_.empty() ? decltype(changed_bands_)::node_type()
                                       : changed_bands_.extract(place);
    BlockId id = kBlack;
    const auto presence_now = presence.empty()
                                  ? std::span<const std::byte>()
                                  : presence.subspan(block * presence_bytes_, presence_bytes_);
    if (!band.empty() || !presence_now.empty() || use_ == Use::lossy_encoder ||
        std::memcmp(now, records_.data(), block_bytes_) != 0) {
      id = free_.back();
      free_.pop_back();
      std::memcpy(records_.data() + id * block_bytes_, now, block_bytes_);
      std::copy(presence_now.begin(), presence_now.end(),
                presence_.begin() + static_cast<std::ptrdiff_t>(id * presence_bytes_));
      if (use_ == Use::server) digests_[id] = checksum(records(id));
    }
    if (!band.empty()) {
      band.key() = id;
      stale_.insert(std::move(band));
    }
    ++holders_[id];
    --holders_[std::exchange(current_[block], id)];
  }
}

/// The blocks whose contents are not the current ones any more.
void BlockHistory::find_changes(const CheckedView<const std::byte>& view,
                                std::span<const std::uint32_t> blocks,
                                std::span<const std::byte> presence) {
  stale_places_.clear();
  changed_.clear();
  changed_bands_.clear();
  stripped_.resize(blocks.size() * block_bytes_);
  strip(isa_, desc_, view, blocks, stripped_, stale_places_);
  auto next_stale = stale_places_.begin();
  for (std::uint32_t place = 0; place < blocks.size(); ++place) {
    const std::uint32_t block = blocks[place];
    const auto now = std::span(stripped_).subspan(std::size_t{place} * block_bytes_, block_bytes_);
    const BlockId before = current_[block];
    bool same = before != kNothing;
    if (!presence.empty()) {
      const auto exists = presence.subspan(block * presence_bytes_, presence_bytes_);
      clear_absent(desc_, exists, now);
      const auto existed = this->presence(before);
      same = same && std::equal(exists.begin(), exists.end(), existed.begin());
    }
    const bool stale = next_stale != stale_places_.end() && *next_stale == place;
    if (stale) {
      ++next_stale;
      gather_band(desc_, view, block, band_);
    }
    const auto band_before = stale_band(before);
    same = same && stale != band_before.empty() &&
           (!stale || std::equal(band_.begin(), band_.end(), band_before.begin())) &&
           std::memcmp(now.data(), records(before).data(), block_bytes_) == 0;
    if (same) continue;
    changed_.push_back(place);
    if (stale) changed_bands_.emplace(place, band_);
  }
}

std::span<const std::byte> BlockHistory::stale_band(BlockId id) const {
  if (stale_.empty()) return {};
  const auto it = stale_.find(id);
  return it == stale_.end() ? std::span<const std::byte>() : it->second;
}

bool BlockHistory::is_zero(BlockId id) const {
  return id <= kBlack || (std::memcmp(records(id).data(), records_.data(), block_bytes_) == 0 &&
                          stale_band(id).empty());
}

bool BlockHistory::same_records(BlockId a, BlockId b) const noexcept {
  return digests_[a] == digests_[b] &&
         std::memcmp(records(a).data(), records(b).data(), block_bytes_) == 0;
}

void BlockHistory::replace(BlockId id, std::span<const std::byte> records) noexcept {
  std::memcpy(records_.data() + id * block_bytes_, records.data(), block_bytes_);
}

/// As many free numbers, at least.
void BlockHistory::make_room(std::size_t blocks) {
  if (blocks <= free_.size()) return;
  collect();
  if (blocks <= free_.size()) return;
  const std::size_t before = holders_.size(), after = before + blocks - free_.size();
  free_.reserve(blocks);
  records_.resize(after * block_bytes_);
  presence_.resize(after * presence_bytes_);
  if (use_ == Use::server) digests_.resize(after);
  holders_.resize(after);
  for (std::size_t id = before; id < after; ++id) free_.push_back(static_cast<BlockId>(id));
  std::sort(free_.begin(), free_.end(), std::greater<>());
}

/// Contents without a holder become free. Done here and not in release(), which may run beside
/// others.
void BlockHistory::collect() {
  free_.clear();
  free_.reserve(holders_.size());
  for (auto id = static_cast<BlockId>(holders_.size()); id-- > 0;) {
    if (holders_[id] > 0) continue;
    if (!stale_.empty()) stale_.erase(id);
    free_.push_back(id);
  }
}

std::size_t BlockHistory::size() const noexcept {
  const auto held = [](std::uint32_t holders) { return holders > 0; };
  return static_cast<std::size_t>(std::count_if(holders_.begin(), holders_.end(), held));
}

std::size_t BlockHistory::memory() const noexcept {
  return records_.capacity() + presence_.capacity() +
         (digests_.capacity() + holders_.capacity()) * sizeof(std::uint32_t) +
         free_.capacity() * sizeof(BlockId) + current_.capacity() * sizeof(BlockId) +
         stripped_.capacity() + stale_.size() * (band_bytes(desc_) + 64);
}

}  // namespace gicodec
