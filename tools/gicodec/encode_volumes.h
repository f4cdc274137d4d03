// The volumes that encode makes of its textures: that of --layout, or one per kind and grid.
#pragma once

#include "common/stored_texture.h"
#include "dump/dump.h"
#include "geometry_flags.h"

#include <gicodec/container.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::tools {

/// Reads the headers of all files, in the order of the container's textures. Throws if they do not
/// make volumes.
[[nodiscard]] std::vector<std::pair<const Sequence*, StoredTexture>> inspect_all(
    const GeometryFlags& flags, const std::vector<Sequence>& sequences);

/// Throws for a texture that no decoder would take.
void require_size(const StoredTexture& texture, const std::string& path);
/// Throws for texels in no block, which would be lost.
void require_nothing_outside(const Dump& dump, const std::string& path);

/// Blocks of a region along each axis by --region; zeros if it is empty. Throws.
[[nodiscard]] Grid region_of(const std::string& flag);

/// Adds the volumes of textures in that order. `output`: the container's path, for messages.
void add_volumes(ContainerDescription& description, const GeometryFlags& flags,
                 std::span<const StoredTexture* const> textures, const std::string& output);

/// A question to the user, with a hint, if DDS files, which do not describe probes and pools, are
/// named like a layout's textures and no flag describes them; else empty.
[[nodiscard]] std::string layout_question(const GeometryFlags& flags,
                                          const std::vector<Sequence>& sequences);

/// What a container says of its textures, in its description and beside it.
struct Described {
  ContainerDescription description;
  std::vector<Metadata> beside;  ///< by texture
};

/// Moves what is long beside the description, so that this stays small. Throws Error of
/// Exit::bad_input with a hint if it is more than a container holds.
void spread_metadata(Described& described, std::size_t frames, const std::string& output);

}  // namespace gicodec::tools
