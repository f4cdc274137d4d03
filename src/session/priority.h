// Which of the probes that a client lacks go into its next packets.
#pragma once

#include <gicodec/texture.h>

#include <cstdint>
#include <vector>

namespace gicodec {

struct Candidate {
  std::uint32_t stream = 0;  ///< whose packet it would go into
  std::uint32_t probe = 0;
  std::uint32_t age = 0;    ///< updates since it is owed
  float change = 0;         ///< 0 to 1: how much of it changed
  std::uint32_t order = 0;  ///< spread_order(), among equals
};

/// An order in which any first part of a grid's probes is spread over it, and neighbours are apart:
/// a codec that predicts from neighbours can code such probes side by side.
[[nodiscard]] std::uint32_t spread_order(const Grid& grid, std::uint32_t probe) noexcept;

/// Keeps the `limit` that are owed longest: those that are worth a look at how much they changed.
void keep_oldest(std::vector<Candidate>& candidates, std::size_t limit);

/// Keeps at most `limit` candidates, in order of stream and probe. Half of the places, rounded up,
/// go to those owed longest, so that no probe waits for more than 2·⌈n / limit⌉ updates while n
/// probes compete; the others to the largest change, weighted with age.
void choose(std::vector<Candidate>& candidates, std::size_t limit);

}  // namespace gicodec
