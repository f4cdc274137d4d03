#include "stream/mirror.h"

#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

namespace gicodec {

/// Calls visit(place, count) for consecutive ones of `blocks`, which are side by side in the mirror
/// too.
template <typename Visit>
static void for_each_run(std::span<const std::uint32_t> blocks, const Visit& visit) {
  for (std::size_t place = 0, count = 1; place < blocks.size(); place += count, count = 1) {
    while (place + count < blocks.size() && blocks[place + count] == blocks[place] + count) ++count;
    visit(place, count);
  }
}

Mirror::Mirror(const TextureDesc& desc)
    : desc_(desc),
      block_bytes_(block_bytes(desc)),
      band_bytes_(band_bytes(desc)),
      records_(block_count(desc) * block_bytes_, std::byte{0}),
      received_(block_count(desc)) {}

void Mirror::make_room(const StaleBands& stale) {
  if (stale.empty() || !stale_.empty()) return;
  bands_.resize(block_count(desc_) * band_bytes_);
  stale_.resize(block_count(desc_));
}

void Mirror::commit(bool keyframe, std::span<const std::uint32_t> blocks,
                    std::span<const std::byte> records, const StaleBands& stale) noexcept {
  if (keyframe) {
    std::fill(records_.begin(), records_.end(), std::byte{0});
    std::fill(received_.begin(), received_.end(), std::uint8_t{0});
    std::fill(stale_.begin(), stale_.end(), std::uint8_t{0});
  }
  for_each_run(blocks, [&](std::size_t place, std::size_t count) {
    const std::uint32_t first = blocks[place];
    std::memcpy(records_.data() + first * block_bytes_, records.data() + place * block_bytes_,
                count * block_bytes_);
    std::memset(received_.data() + first, 1, count);
    if (!stale_.empty()) std::memset(stale_.data() + first, 0, count);
  });
  for (std::size_t i = 0; i < stale.size(); ++i) {
    const std::uint32_t block = stale.blocks()[i];
    std::memcpy(bands_.data() + block * band_bytes_, stale.band(i).data(), band_bytes_);
    stale_[block] = 1;
  }
}

void Mirror::write(Isa isa, const CheckedView<std::byte>& view,
                   std::span<const std::uint32_t> blocks) const noexcept {
  for_each_run(blocks, [&](std::size_t place, std::size_t count) {
    reconstruct(isa, desc_, view, blocks.subspan(place, count),
                records().subspan(blocks[place] * block_bytes_));
  });
  if (stale_.empty()) return;
  for (const std::uint32_t block : blocks) {
    const auto held = stale_band(block);
    if (!held.empty()) scatter_band(desc_, view, block, held);
  }
}

void Mirror::write_all(Isa isa, const CheckedView<std::byte>& view) const noexcept {
  std::array<std::uint32_t, 512> some;  // At a time: nothing is allocated.
  const std::uint32_t total = block_count(desc_);
  for (std::uint32_t first = 0; first < total;) {
    const auto count = std::min<std::uint32_t>(some.size(), total - first);
    const auto blocks = std::span(some).first(count);
    std::iota(blocks.begin(), blocks.end(), first);
    write(isa, view, blocks);
    first += count;
  }
}

}  // namespace gicodec
