// What updates of a few probes cost: most of what clients of regions and tight budgets get.
#pragma once

#include "cases.h"

namespace gicodec::bench {

/// What differs between the first two frames.
[[nodiscard]] std::vector<std::uint32_t> changed_probes(const Texture& t);
/// `count` of them, spread or side by side. Precondition: there are as many.
[[nodiscard]] std::vector<std::uint32_t> choose_probes(const std::vector<std::uint32_t>& changed,
                                                       std::size_t count, bool spread);

/// Prints bytes per probe and microseconds of updates of a few probes that changed, side by side
/// and spread over the volume.
void report_small_updates(const Texture& texture, Isa isa);

}  // namespace gicodec::bench
