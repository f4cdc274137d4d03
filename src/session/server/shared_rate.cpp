#include "session/server/shared_rate.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

// Consecutive places and groups are far apart in every period of 2, 4, ... 32 updates.
constexpr std::uint64_t kPlaces = 13, kGroups = 9;
/// With many streams every update has some; with few, groups of clients take turns.
constexpr std::size_t kMaxTurns = 4, kManyStreams = 64;

/// Maps any run of numbers evenly to 0..1.
float spread(std::size_t place) noexcept {
  constexpr std::uint32_t kGolden = 0x9E3779B1;
  return static_cast<float>(static_cast<std::uint32_t>(place) * kGolden >> 8) / (1U << 24);
}

}  // namespace

void SharedRate::choose(const Budget& budget, std::size_t streams,
                        std::size_t bytes_of_a_stream) noexcept {
  if (!measured_) bytes_ = static_cast<float>(bytes_of_a_stream) / kGuessedRatio;
  streams_ = streams;
  groups_ = static_cast<std::uint32_t>(
      std::clamp<std::size_t>(kManyStreams / std::max<std::size_t>(streams, 1), 1, kMaxTurns));
  share_ = 1;
  const auto limit = [&](auto most, float in_a_turn) {
    const float all = in_a_turn * static_cast<float>(streams);
    if (most != 0 && all > 0) share_ = std::min(share_, static_cast<float>(most) / all);
  };
  limit(budget.bytes, bytes_);
  limit(budget.blocks, blocks_);
  share_ = std::max(share_, std::ldexp(1.0F, -static_cast<int>(kSlowest)));
  tier_ = std::min(kSlowest, static_cast<unsigned>(-std::floor(std::log2(share_))));
  // This share of the streams takes part twice as often, so that the average is share_.
  faster_ = tier_ == 0 ? 1 : std::ldexp(share_, static_cast<int>(tier_)) - 1;
}

unsigned SharedRate::tier(std::size_t place) const noexcept {
  return tier_ > 0 && spread(place) < faster_ ? tier_ - 1 : tier_;
}

bool SharedRate::turn(std::uint64_t update, std::size_t place) const noexcept {
  const std::uint64_t phase = kPlaces * place + kGroups * (group_ % groups_);
  return ((update + phase) & ((std::uint64_t{1} << tier(place)) - 1)) == 0;
}

void SharedRate::sent(std::size_t turns, std::size_t bytes, std::size_t blocks) noexcept {
  if (turns == 0) return;
  const float part = static_cast<float>(turns) / static_cast<float>(std::max(turns, streams_));
  const float weight = measured_ ? std::max(part, 1.0F / 16) / 2 : 1;
  measured_ = true;
  const auto mix = [&](float& value, std::size_t now) {
    value += weight * (static_cast<float>(now) / static_cast<float>(turns) - value);
  };
  mix(bytes_, bytes);
  mix(blocks_, blocks);
}

}  // namespace gicodec
