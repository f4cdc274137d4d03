#include "stream/mirror.h"

#include "base/parallel.h"
#include "texture/blocks.h"
#include "texture/guard_band.h"
#include "texture/presence.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <numeric>

namespace gicodec {

/// Calls visit(place, count) for runs of consecutive `blocks`, which are side by side in the
/// mirror; short enough to stay in the cache between two steps.
template <typename Visit>
static void for_each_run(std::span<const std::uint32_t> blocks, const Visit& visit) {
  constexpr std::size_t kMaxRun = 64;
  for (std::size_t place = 0, count = 1; place < blocks.size(); place += count, count = 1) {
    const std::size_t left = std::min(kMaxRun, blocks.size() - place);
    while (count < left && blocks[place + count] == blocks[place] + count) ++count;
    visit(place, count);
  }
}

Mirror::Mirror(const TextureDesc& desc, Isa isa, const Threads& threads)
    : desc_(desc),
      isa_(isa),
      threads_(threads),
      block_bytes_(block_bytes(desc)),
      band_bytes_(band_bytes(desc)),
      presence_bytes_(kept_presence(desc)),
      records_(block_count(desc) * block_bytes_, std::byte{0}),
      presence_(block_count(desc) * presence_bytes_, std::byte{0}),
      received_(block_count(desc)) {}

void Mirror::make_room(const StaleBands& stale) {
  if (stale.empty() || !stale_.empty()) return;
  bands_.resize(block_count(desc_) * band_bytes_);
  stale_.resize(block_count(desc_));
}

void Mirror::commit(bool keyframe, std::span<const std::uint32_t> blocks,
                    Vector<std::byte>& records, std::span<const std::byte> presence,
                    const StaleBands& stale, const CheckedView<std::byte>* view) noexcept {
  const bool clears = keyframe && blocks.size() < received_.size();
  if (clears) {
    std::fill(records_.begin(), records_.end(), std::byte{0});
    std::fill(presence_.begin(), presence_.end(), std::byte{0});
    std::fill(received_.begin(), received_.end(), std::uint8_t{0});
    std::fill(stale_.begin(), stale_.end(), std::uint8_t{0});
  } else if (!stale_.empty()) {
    for (const std::uint32_t block : blocks) stale_[block] = 0;
  }
  for (std::size_t i = 0; i < stale.size(); ++i) {
    const std::uint32_t block = stale.blocks()[i];
    std::memcpy(bands_.data() + block * band_bytes_, stale.band(i).data(), band_bytes_);
    stale_[block] = 1;
  }
  // Memory that other textures share may be larger than what a mirror may hold.
  const bool exchanges =
      blocks.size() == received_.size() && records.capacity() == records_.capacity();
  if (exchanges) records_.swap(records);
  const auto commit_range = [&](unsigned, std::size_t first, std::size_t size) {
    const auto some = blocks.subspan(first, size);
    for_each_run(some, [&](std::size_t place, std::size_t count) {
      const std::size_t block = some[place];
      if (!exchanges) {
        std::memcpy(records_.data() + block * block_bytes_,
                    records.data() + (first + place) * block_bytes_, count * block_bytes_);
      }
      if (presence_bytes_ != 0) {
        std::memcpy(presence_.data() + block * presence_bytes_,
                    presence.data() + (first + place) * presence_bytes_, count * presence_bytes_);
      }
      std::memset(received_.data() + block, 1, count);
      if (view != nullptr && !clears)
        write_run(some[place], desc_, *view, some.subspan(place, count));
    });
  };
  for_each_range(threads_, blocks.size(), blocks_per_thread(desc_), commit_range);
  if (view != nullptr && clears) write_all(*view);
}

/// Writes blocks from `first` on, side by side.
void Mirror::write_run(std::uint32_t first, const TextureDesc& to,
                       const CheckedView<std::byte>& view,
                       std::span<const std::uint32_t> places) const noexcept {
  reconstruct(isa_, to, view, places, records().subspan(first * block_bytes_));
  if (stale_.empty()) return;
  for (const std::uint32_t place : places) {
    const auto held = stale_band(first++);
    if (!held.empty()) scatter_band(to, view, place, held);
  }
}

void Mirror::write(std::span<const std::uint32_t> blocks, const TextureDesc& to,
                   const CheckedView<std::byte>& view,
                   std::span<const std::uint32_t> places) const noexcept {
  const auto write_range = [&](unsigned, std::size_t first, std::size_t size) {
    const auto some = blocks.subspan(first, size), there = places.subspan(first, size);
    for_each_run(some, [&](std::size_t at, std::size_t count) {
      write_run(some[at], to, view, there.subspan(at, count));
    });
  };
  // Two threads must not write the same block.
  const bool unique =
      std::adjacent_find(places.begin(), places.end(), std::greater_equal<>()) == places.end();
  for_each_range(unique ? threads_ : Threads(), blocks.size(), blocks_per_thread(desc_),
                 write_range);
}

void Mirror::write_all(const CheckedView<std::byte>& view) const noexcept {
  const auto write_range = [&](unsigned, std::size_t begin, std::size_t size) {
    std::array<std::uint32_t, 512> some;  // a few at a time, to allocate nothing
    for (std::size_t done = 0; done < size;) {
      const auto blocks = std::span(some).first(std::min(some.size(), size - done));
      std::iota(blocks.begin(), blocks.end(), static_cast<std::uint32_t>(begin + done));
      write_run(blocks[0], desc_, view, blocks);
      done += blocks.size();
    }
  };
  for_each_range(threads_, received_.size(), blocks_per_thread(desc_), write_range);
}

}  // namespace gicodec
