// Flags that say what texture a file holds where its attributes do not.
#pragma once

#include "common/command_line.h"
#include "dump/dump.h"
#include "dump/sequence.h"

#include <gicodec/kind.h>

#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

/// Values of --grid, --core, --guard-band, --tiling, --block, --extent, --vk-format and --channels,
/// each VALUE or NAME=VALUE; and of --layout.
struct GeometryFlags {
  std::vector<std::string> grid, core, guard_band, tiling, block, extent, format, channels;
  std::string layout;
};

void add_geometry_flags(Command& command, GeometryFlags& flags);
/// What the flags say about a texture: NAME=VALUE beats VALUE, later flags beat earlier ones.
/// Throws Error of Exit::usage for a value that makes no sense.
[[nodiscard]] Hints hints_for(const GeometryFlags& flags, const std::string& texture);

/// The volume of --layout and --grid; nullopt without --layout. Throws Error of Exit::usage where
/// they make none, and for a flag beside them that says something else.
[[nodiscard]] std::optional<VolumeDesc> layout_volume(const GeometryFlags& flags);
/// "irradiance, distance": what its textures are called.
[[nodiscard]] std::string texture_names(const VolumeDesc& volume);

/// Throws Error of Exit::usage for a NAME that none of the textures has.
void check_names(const GeometryFlags& flags, const std::vector<Sequence>& textures);

}  // namespace gicodec::tools
