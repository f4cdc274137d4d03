// A parse that takes its time: literals and matches that save most bits.
#pragma once

#include "native/matches/byte_order.h"
#include "native/matches/match_memory.h"

namespace gicodec::native {

/// Fills `memory.parts` with those of `memory.bytes`. `looks`: at most so many earlier places are
/// looked at for each.
void parse_bytes(const Distances& distances, unsigned looks, MatchMemory& memory);

}  // namespace gicodec::native
