#include "stream/block_history.h"

#include "base/checksum.h"
#include "texture/blocks.h"
#include "texture/guard_band.h"
#include "texture/presence.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gicodec {

/// Blocks stripped at a time: few enough to be in the cache when they are compared.
static constexpr std::size_t kStep = 64;

BlockHistory::BlockHistory(const TextureDesc& desc, Isa isa, Use use)
    : desc_(desc),
      isa_(isa),
      use_(use),
      block_bytes_(block_bytes(desc)),
      presence_bytes_(presence_bytes(desc)),
      records_(block_bytes_),
      presence_(presence_bytes_),
      digests_(use == Use::server ? 1 : 0, checksum(records_)),
      holders_{1 + block_count(desc)},
      current_(block_count(desc), kNothing),
      band_(band_bytes(desc)) {}

void BlockHistory::publish(const CheckedView<const std::byte>& view,
                           std::span<const std::uint32_t> blocks,
                           std::span<const std::byte> presence) {
  make_room(blocks.size());
  changed_.clear();
  changed_.reserve(blocks.size());
  for (std::size_t first = 0; first < blocks.size();) {
    // Straight to where they stay if they changed: under free numbers side by side.
    const std::size_t left = std::min(kStep, blocks.size() - first);
    std::size_t count = 1;
    while (count < left && free_[first + count] == free_[first] + count) ++count;
    stale_places_.clear();
    strip(isa_, desc_, view, blocks.subspan(first, count), at(free_[first], count), stale_places_);
    auto next_stale = stale_places_.begin();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = first + i;
      const BlockId id = free_[place], before = current_[blocks[place]];
      if (!presence.empty()) {
        const auto exists = presence.subspan(blocks[place] * presence_bytes_, presence_bytes_);
        clear_absent(desc_, exists, at(id, 1));
        std::memcpy(presence_.data() + id * presence_bytes_, exists.data(), presence_bytes_);
      }
      if (next_stale != stale_places_.end() && *next_stale == i) {
        ++next_stale;
        gather_band(desc_, view, blocks[place], band_);
        stale_.emplace(id, band_);
      }
      const bool same = before != kNothing && equal(before, id);
      if (!same) changed_.push_back(static_cast<std::uint32_t>(place));
    }
    first += count;
  }
  // From here on nothing can fail.
  for (const std::uint32_t place : changed_) {
    const BlockId id = free_[place];
    if (use_ == Use::server) digests_[id] = checksum(records(id));
    holders_[id] = 1;
    --holders_[std::exchange(current_[blocks[place]], id)];
  }
}

bool BlockHistory::equal(BlockId a, BlockId b) const {
  if (std::memcmp(records(a).data(), records(b).data(), block_bytes_) != 0) return false;
  const auto exists_a = presence(a), exists_b = presence(b);
  const auto band_a = stale_band(a), band_b = stale_band(b);
  return std::equal(exists_a.begin(), exists_a.end(), exists_b.begin()) &&
         std::equal(band_a.begin(), band_a.end(), band_b.begin(), band_b.end());
}

std::span<const std::byte> BlockHistory::stale_band(BlockId id) const {
  if (stale_.empty()) return {};
  const auto it = stale_.find(id);
  return it == stale_.end() ? std::span<const std::byte>() : it->second;
}

bool BlockHistory::is_zero(BlockId id) const {
  return std::memcmp(records(id).data(), records_.data(), block_bytes_) == 0 &&
         stale_band(id).empty();
}

bool BlockHistory::same_records(BlockId a, BlockId b) const noexcept {
  return digests_[a] == digests_[b] &&
         std::memcmp(records(a).data(), records(b).data(), block_bytes_) == 0;
}

void BlockHistory::replace(BlockId id, std::span<const std::byte> records) noexcept {
  std::memcpy(records_.data() + id * block_bytes_, records.data(), block_bytes_);
}

/// Collects numbers that nobody holds, one for each block. Done here and not in release(), which
/// may run beside others.
void BlockHistory::make_room(std::size_t blocks) {
  std::erase_if(stale_, [&](const auto& band) { return holders_[band.first] == 0; });
  free_.clear();
  free_.reserve(blocks);
  const auto collect = [&](std::size_t id) {
    for (; id < holders_.size() && free_.size() < blocks; ++id) {
      if (holders_[id] == 0) free_.push_back(static_cast<BlockId>(id));
    }
  };
  collect(0);
  const std::size_t before = holders_.size(), room = before + blocks - free_.size();
  if (room == before) return;
  records_.resize(room * block_bytes_);
  presence_.resize(room * presence_bytes_);
  if (use_ == Use::server) digests_.resize(room);
  holders_.resize(room);
  collect(before);
}

std::size_t BlockHistory::size() const noexcept {
  const auto held = [](std::uint32_t holders) { return holders > 0; };
  return static_cast<std::size_t>(std::count_if(holders_.begin(), holders_.end(), held));
}

std::size_t BlockHistory::memory() const noexcept {
  return records_.capacity() + presence_.capacity() +
         (digests_.capacity() + holders_.capacity() + free_.capacity() + current_.capacity() +
          changed_.capacity()) *
             sizeof(std::uint32_t) +
         stale_.size() * (band_bytes(desc_) + 64);
}

}  // namespace gicodec
