// Flags that describe the texture of a file whose attributes do not.
#pragma once

#include "common/command_line.h"
#include "dump/dump.h"
#include "dump/sequence.h"

#include <gicodec/kind.h>

#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

/// The values of --grid, --core, --guard-band, --tiling, --block, --extent, --vk-format and
/// --channels, each VALUE or NAME=VALUE, and of --layout.
struct GeometryFlags {
  std::vector<std::string> grid, core, guard_band, tiling, block, extent, format, channels;
  std::string layout;
  NumberOptions numbers;
};

void add_geometry_flags(Command& command, GeometryFlags& flags);
/// The flags as a command line has them: " --grid 4x4x4".
[[nodiscard]] std::string flags_text(const GeometryFlags& flags);
/// --stills and --frames-from.
void add_number_flags(Command& command, NumberOptions& numbers);
/// The flags of a texture: NAME=VALUE overrides VALUE, later flags override earlier ones. Throws
/// Error of Exit::usage for an invalid value.
[[nodiscard]] Hints hints_for(const GeometryFlags& flags, const std::string& texture);

/// The volume of --layout and --grid; nullopt without --layout. Throws Error of Exit::usage if they
/// do not make one, and for another flag that contradicts it.
[[nodiscard]] std::optional<VolumeDesc> layout_volume(const GeometryFlags& flags);
/// Names of a volume's textures: "irradiance, distance".
[[nodiscard]] std::string texture_names(const VolumeDesc& volume);

/// Throws Error of Exit::usage for a NAME that none of the textures has.
void check_names(const GeometryFlags& flags, const std::vector<Sequence>& textures);

}  // namespace gicodec::tools
