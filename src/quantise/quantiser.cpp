#include "quantise/quantiser.h"

#include "texture/blocks.h"
#include "texture/presence.h"

#include <algorithm>
#include <array>

namespace gicodec {

/// Blocks whose cost is estimated for all.
static constexpr std::size_t kAsked = 64;
/// Jumps here and there take backends more than is estimated, above all without a step in common.
static constexpr double kJumps = 1, kJumpsWithoutStep = 1.6;

Quantiser::Quantiser(const TextureDesc& desc, Isa isa, float max_error)
    : desc_(desc),
      isa_(isa),
      grid_(desc.record, max_error),
      block_bytes_(block_bytes(desc)),
      given_(exact() ? 0 : block_bytes_ * block_count(desc)) {
  if (exact()) return;
  const CodingCost cost(desc.record, desc.block.x);
  costs_.emplace(Costs{cost, cost, cost, cost});
}

// All get it in one way, as values have a step in common only if none leaves the grid.
void Quantiser::begin(const CheckedView<const std::byte>& view,
                      std::span<const std::uint32_t> blocks, std::span<const std::byte> presence,
                      const MirrorView& held) {
  blocks_.assign(blocks.begin(), blocks.end());
  next_given_.resize(blocks.size() * block_bytes_);
  auto& [exact, to_grid, follow, stay] = *costs_;
  for (CodingCost* cost : {&exact, &to_grid, &follow, &stay}) cost->clear();
  const std::size_t asked = std::min(kAsked, blocks.size());
  // Evenly spread, and in no step with the grid.
  const auto place = [&](std::uint64_t i) -> std::size_t {
    constexpr std::uint64_t kGolden = 0x9E3779B1;
    if (asked == blocks.size()) return static_cast<std::size_t>(i);
    return static_cast<std::size_t>((i * kGolden & UINT32_MAX) * blocks.size() >> 32);
  };
  bool stepped = true;
  for (std::size_t i = 0; i < asked && stepped; ++i) {
    stepped = grid_.holds(held.blocks[blocks[place(i)]]);
  }
  std::array<std::uint32_t, kMaxComponents> ones{};
  ones.fill(1);
  const auto steps = grid_.steps();
  now_.resize(block_bytes_);
  for (std::size_t i = 0; i < asked; ++i) {
    const auto some = blocks.subspan(place(i), 1);
    const std::uint32_t block = some[0];
    std::span<const std::byte> exists;
    stale_.clear();
    strip(isa_, desc_, view, some, now_, stale_);
    if (!presence.empty()) {
      exists = presence.subspan(block * presence_bytes(desc_), presence_bytes(desc_));
      clear_absent(desc_, exists, now_);
    }
    tried_.assign(now_.begin(), now_.end());
    if (!held.is_received(block)) {
      exact.add(now_, {}, ones);
      grid_.apply(tried_, {});
      to_grid.add(tried_, {}, steps);
      continue;
    }
    grid_.apply(now_, held.blocks[block], given(block));
    grid_.apply(tried_, held.blocks[block]);
    // What existed does not move on as what does not.
    if (!exists.empty()) {
      clear_absent(desc_, exists, now_);
      clear_absent(desc_, exists, tried_);
    }
    follow.add(now_, held.blocks[block], ones);
    stay.add(tried_, held.blocks[block], stepped ? steps : ones);
  }
  exact_ = exact.bits() < to_grid.bits();
  follow_ = follow.bits() < (stepped ? kJumps : kJumpsWithoutStep) * stay.bits();
}

void Quantiser::apply(std::size_t i, const MirrorView& held, std::span<const std::byte> exists,
                      std::span<std::byte> records) noexcept {
  const std::uint32_t block = blocks_[i];
  std::copy(records.begin(), records.end(), next_given_.data() + i * block_bytes_);
  if (held.is_received(block)) {
    grid_.apply(records, held.blocks[block], follow_ ? given(block) : std::span<const std::byte>());
  } else if (!exact_) {
    grid_.apply(records, {});
  }
  // What existed does not move on as what does not.
  if (!exists.empty()) clear_absent(desc_, exists, records);
}

void Quantiser::swap() noexcept {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const auto now = given(blocks_[i]);
    std::swap_ranges(now.begin(), now.end(), next_given_.data() + i * block_bytes_);
  }
}

std::size_t Quantiser::memory() const noexcept {
  return given_.capacity() + next_given_.capacity() + now_.capacity() + tried_.capacity() +
         (blocks_.capacity() + stale_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace gicodec
