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
      stripped_(std::min<std::size_t>(kStep, block_count(desc)) * block_bytes_),
      band_(band_bytes(desc)) {}

void BlockHistory::publish(const CheckedView<const std::byte>& view,
                           std::span<const std::uint32_t> blocks,
                           std::span<const std::byte> presence) {
  make_room(blocks.size());
  changed_.clear();
  changed_.reserve(blocks.size());
  std::size_t next = 0;  // Of the free numbers.
  for (std::size_t first = 0; first < blocks.size(); first += kStep) {
    const auto some = blocks.subspan(first, std::min(kStep, blocks.size() - first));
    // To where they stay if they changed, if as many free numbers are side by side.
    const bool there = free_[next + some.size() - 1] - free_[next] == some.size() - 1;
    const auto stripped = there ? at(free_[next], some.size()) : std::span(stripped_);
    stale_places_.clear();
    strip(isa_, desc_, view, some, stripped, stale_places_);
    auto next_stale = stale_places_.begin();
    std::size_t taken = 0;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const auto records = stripped.subspan(i * block_bytes_, block_bytes_);
      std::span<const std::byte> exists, band;
      if (!presence.empty()) {
        exists = presence.subspan(some[i] * presence_bytes_, presence_bytes_);
        clear_absent(desc_, exists, records);
      }
      if (next_stale != stale_places_.end() && *next_stale == i) {
        ++next_stale;
        gather_band(desc_, view, some[i], band_);
        band = band_;
      }
      if (is_current(some[i], records, exists, band)) continue;
      const BlockId id = free_[next + (there ? i : taken)];
      ++taken;
      if (!there) replace(id, records);
      std::copy(exists.begin(), exists.end(), presence_.data() + id * presence_bytes_);
      if (!band.empty()) stale_.emplace(id, band_);
      changed_.emplace_back(some[i], id);
    }
    next += there && taken > 0 ? some.size() : taken;
  }
  // From here on nothing can fail.
  for (const auto& [block, id] : changed_) {
    if (use_ == Use::server) digests_[id] = checksum(records(id));
    holders_[id] = 1;
    --holders_[std::exchange(current_[block], id)];
  }
}

bool BlockHistory::is_current(std::uint32_t block, std::span<const std::byte> records,
                              std::span<const std::byte> exists,
                              std::span<const std::byte> band) const {
  const BlockId id = current_[block];
  if (id == kNothing || std::memcmp(records.data(), this->records(id).data(), block_bytes_) != 0) {
    return false;
  }
  const auto existed = presence(id), band_before = stale_band(id);
  return std::equal(exists.begin(), exists.end(), existed.begin()) &&
         std::equal(band.begin(), band.end(), band_before.begin(), band_before.end());
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
  const std::size_t before = holders_.size();
  free_.resize(before + blocks);
  std::size_t found = 0;
  // Nothing is held by more than can be counted. Without a branch: who holds what has no order.
  for (std::size_t id = kNothing + 1; id < before; ++id) {
    free_[found] = static_cast<BlockId>(id);
    found += holders_[id] == 0 ? 1 : 0;
  }
  if (found >= blocks) return;
  const std::size_t after = before + blocks - found;
  records_.resize(after * block_bytes_);
  presence_.resize(after * presence_bytes_);
  if (use_ == Use::server) digests_.resize(after);
  holders_.resize(after);
  for (std::size_t id = before; id < after; ++id) free_[found++] = static_cast<BlockId>(id);
}

std::size_t BlockHistory::size() const noexcept {
  const auto held = [](std::uint32_t holders) { return holders > 0; };
  return static_cast<std::size_t>(std::count_if(holders_.begin(), holders_.end(), held));
}

std::size_t BlockHistory::memory() const noexcept {
  return records_.capacity() + presence_.capacity() + stripped_.capacity() +
         (digests_.capacity() + holders_.capacity() + free_.capacity() + current_.capacity()) *
             sizeof(std::uint32_t) +
         changed_.capacity() * sizeof changed_[0] + stale_.size() * (band_bytes(desc_) + 64);
}

}  // namespace gicodec
