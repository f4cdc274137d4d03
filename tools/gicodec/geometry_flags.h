// Flags that say what texture a file holds where its attributes do not.
#pragma once

#include "command_line/command_line.h"
#include "dump/dump.h"
#include "dump/sequence.h"

#include <string>
#include <vector>

namespace gicodec::tools {

/// Values of --grid, --core, --guard-band, --tiling, --vk-format and --channels, each VALUE or
/// NAME=VALUE.
struct GeometryFlags {
  std::vector<std::string> grid, core, guard_band, tiling, format, channels;
};

void add_geometry_flags(Command& command, GeometryFlags& flags);
/// What the flags say about a texture: NAME=VALUE beats VALUE, later flags beat earlier ones.
/// Throws Error of Exit::usage for a value that makes no sense.
[[nodiscard]] Hints hints_for(const GeometryFlags& flags, const std::string& texture);

/// Throws Error of Exit::usage for a NAME that none of the textures has.
void check_names(const GeometryFlags& flags, const std::vector<Sequence>& textures);

}  // namespace gicodec::tools
