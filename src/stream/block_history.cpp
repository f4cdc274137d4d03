#include "stream/block_history.h"

#include "base/checksum.h"
#include "base/parallel.h"
#include "texture/blocks.h"
#include "texture/guard_band.h"
#include "texture/presence.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gicodec {

/// Blocks stripped at a time: few enough to stay in the cache until they are compared.
static constexpr std::size_t kStep = 64;

BlockHistory::BlockHistory(const TextureDesc& desc, Isa isa, Use use, const Threads& threads,
                           float max_error)
    : desc_(desc),
      isa_(isa),
      use_(use),
      threads_(threads),
      quantiser_(desc, isa, max_error),
      block_bytes_(block_bytes(desc)),
      presence_bytes_(presence_bytes(desc)),
      records_(block_bytes_),
      presence_(presence_bytes_),
      digests_(use == Use::server ? 1 : 0, checksum(records_)),
      holders_{1 + block_count(desc)},
      current_(block_count(desc), kNothing),
      scratch_(threads.count) {}

void BlockHistory::publish(const CheckedView<const std::byte>& view,
                           std::span<const std::uint32_t> blocks,
                           std::span<const std::byte> presence) {
  make_room(blocks.size());
  published_.resize(blocks.size());
  if (lossy()) quantiser_.begin(view, blocks, presence, held());
  for_each_range(threads_, blocks.size(), blocks_per_thread(desc_),
                 [&](unsigned thread, std::size_t first, std::size_t count) {
                   publish_range(view, blocks.subspan(first, count), presence,
                                 std::span(free_).subspan(first, count),
                                 std::span(published_).subspan(first, count), scratch_[thread]);
                 });
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!published_[i].stale) continue;
    gather_band(desc_, view, blocks[i], stale_room(published_[i].id));
  }
  // From here on nothing can fail.
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    Published& one = published_[i];
    one.block = blocks[i];
    if (one.id == kNothing) continue;
    holders_[one.id] = 1;
    one.before = std::exchange(current_[one.block], one.id);
    --holders_[one.before];
  }
  if (lossy()) quantiser_.swap();
}

void BlockHistory::undo() noexcept {
  for (const Published& one : published_) {
    if (one.id == kNothing) continue;
    current_[one.block] = one.before;
    ++holders_[one.before];
    --holders_[one.id];
  }
  if (lossy() && !published_.empty()) quantiser_.swap();
  published_.clear();
}

/// Gives each of `blocks` that changed a number from `free`, which has as many.
void BlockHistory::publish_range(const CheckedView<const std::byte>& view,
                                 std::span<const std::uint32_t> blocks,
                                 std::span<const std::byte> presence, std::span<const BlockId> free,
                                 std::span<Published> published, Scratch& scratch) {
  auto& [stale, band, room] = scratch;
  const auto begin = static_cast<std::size_t>(published.data() - published_.data());
  band.resize(band_bytes(desc_));
  std::size_t next = 0;  // index into `free`
  for (std::size_t first = 0; first < blocks.size(); first += kStep) {
    const auto some = blocks.subspan(first, std::min(kStep, blocks.size() - first));
    // If enough free numbers are consecutive, strips straight to the records' final place.
    const bool there = free[next + some.size() - 1] - free[next] == some.size() - 1;
    if (!there) room.resize(std::min(kStep, blocks.size()) * block_bytes_);
    const auto stripped = there ? at(free[next], some.size()) : std::span(room);
    stale.clear();
    strip(isa_, desc_, view, some, stripped, stale);
    auto next_stale = stale.begin();
    std::size_t taken = 0;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const auto records = stripped.subspan(i * block_bytes_, block_bytes_);
      std::span<const std::byte> exists;
      if (!presence.empty()) {
        exists = presence.subspan(some[i] * presence_bytes_, presence_bytes_);
        clear_absent(desc_, exists, records);
      }
      if (lossy()) quantiser_.apply(begin + first + i, held(), exists, records);
      const bool is_stale = next_stale != stale.end() && *next_stale == i;
      if (is_stale) {
        ++next_stale;
        gather_band(desc_, view, some[i], band);
      }
      published[first + i] = {};
      if (is_current(some[i], records, exists, std::span(band).first(is_stale ? band.size() : 0)))
        continue;
      const BlockId id = free[next + (there ? i : taken)];
      ++taken;
      if (!there) replace(id, records);
      std::copy(exists.begin(), exists.end(), presence_.data() + id * presence_bytes_);
      if (use_ == Use::server) digests_[id] = checksum(records);
      published[first + i] = {id, is_stale, 0, kNothing};
    }
    next += there && taken > 0 ? some.size() : taken;
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

std::span<std::byte> BlockHistory::stale_room(BlockId id) {
  if (!spare_.empty() && !stale_.contains(id)) {
    spare_.back().key() = id;
    stale_.insert(std::move(spare_.back()));
    spare_.pop_back();
  }
  auto& band = stale_[id];
  band.resize(band_bytes(desc_));
  return band;
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
  if (use_ == Use::server) digests_[id] = checksum(records);
}

/// Collects numbers without holders, one for each block, from where it stopped the last time.
/// release() cannot do this, since threads may run it at once.
void BlockHistory::make_room(std::size_t blocks) {
  for (auto it = stale_.begin(); it != stale_.end();) {
    const auto band = it++;
    if (holders_[band->first] != 0) continue;
    spare_.reserve(spare_.size() + 1);
    spare_.push_back(stale_.extract(band));
  }
  constexpr std::size_t kRun = 64;
  if (free_.size() < blocks + kRun) free_.resize(blocks + kRun);
  const std::size_t before = holders_.size();
  std::size_t found = 0;
  const auto collect = [&](std::size_t id, std::size_t end) {
    while (id < end && found < blocks) {
      // Branch-free: holders have no order.
      for (const std::size_t stop = std::min(end, id + kRun); id < stop; ++id) {
        free_[found] = static_cast<BlockId>(id);
        found += holders_[id] == 0 ? 1 : 0;
      }
    }
  };
  // Skips kNothing, whose count may overflow.
  const std::size_t first = std::clamp<std::size_t>(next_free_, kNothing + 1, before);
  collect(first, before);
  const auto wrapped = static_cast<std::ptrdiff_t>(found);
  collect(kNothing + 1, first);
  if (found >= blocks) {
    if (blocks > 0) next_free_ = free_[blocks - 1] + 1;
    return;
  }
  // Ascending: numbers as far apart as their places are consecutive.
  std::rotate(free_.begin(), free_.begin() + wrapped,
              free_.begin() + static_cast<std::ptrdiff_t>(found));
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
  std::size_t scratch = 0;
  for (const auto& [stale, band, room] : scratch_) {
    scratch += stale.capacity() * sizeof stale[0] + band.capacity() + room.capacity();
  }
  return records_.capacity() + presence_.capacity() + quantiser_.memory() + scratch +
         (digests_.capacity() + holders_.capacity() + free_.capacity() + current_.capacity()) *
             sizeof(std::uint32_t) +
         published_.capacity() * sizeof published_[0] +
         (stale_.size() + spare_.size()) * (band_bytes(desc_) + 64);
}

}  // namespace gicodec
