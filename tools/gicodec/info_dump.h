// gicodec info of a dump.
#pragma once

#include "geometry_flags.h"

#include <string>

namespace gicodec::tools {

/// True if a path names a dump by its ending, and is no container.
[[nodiscard]] bool is_dump(const std::string& path);
/// Says what a dump holds and the command that packs it, as text or JSON.
void print_dump(const std::string& path, const GeometryFlags& flags, bool json);

}  // namespace gicodec::tools
