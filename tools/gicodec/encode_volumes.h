// What volumes a container is to have of the textures that encode is given: those of --layout, or
// one per kind and grid.
#pragma once

#include "common/stored_texture.h"
#include "geometry_flags.h"

#include <gicodec/container.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::tools {

/// The headers of all files, in the order of the container's textures. Throws where they do not
/// make volumes.
[[nodiscard]] std::vector<std::pair<const Sequence*, StoredTexture>> inspect_all(
    const GeometryFlags& flags, const std::vector<Sequence>& sequences);

/// Adds the volumes of textures in that order. `output` is for messages.
void add_volumes(ContainerDescription& description, const GeometryFlags& flags,
                 std::span<const StoredTexture* const> textures, const std::string& output);

/// Where DDS files, which say nothing of probes and pools, are named as a layout's textures and no
/// flag says more: a question to the user, with what to do; else empty.
[[nodiscard]] std::string layout_question(const GeometryFlags& flags,
                                          const std::vector<Sequence>& sequences);

}  // namespace gicodec::tools
