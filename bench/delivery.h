// What matters on a link: how long an update takes from end to end.
#pragma once

#include "cases.h"

#include <iosfwd>

namespace gicodec::bench {

/// Prints how long each backend takes for updates of all textures, of every probe and of a few, and
/// which one delivers them first at which speeds of a link.
void report_delivery(const std::string& path, const std::vector<Texture>& textures, bool quick,
                     Isa isa, unsigned threads, std::ostream& json);

}  // namespace gicodec::bench
