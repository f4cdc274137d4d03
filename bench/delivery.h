// What matters on a link: how long an update takes from end to end.
#pragma once

#include "cases.h"

namespace gicodec::bench {

/// Prints how long each backend takes for an update of every probe of all textures, and the speeds
/// of a link at which native delivers it first.
void report_delivery(const std::string& path, const std::vector<Texture>& textures, bool quick,
                     Isa isa, unsigned threads);

}  // namespace gicodec::bench
