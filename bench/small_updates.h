// What updates of a few probes cost: most of what clients of regions and tight budgets get.
#pragma once

#include "cases.h"

namespace gicodec::bench {

/// Prints bytes per probe and microseconds of updates of a few probes that changed, side by side
/// and spread over the volume.
void report_small_updates(const Texture& texture, Isa isa);

}  // namespace gicodec::bench
