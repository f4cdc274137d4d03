// Which vertices of a grid a vertex may be predicted from (docs/native/hemispheres.md).
#pragma once

#include "native/models/light/known_lights.h"

#include <gicodec/backend.h>

#include <span>

namespace gicodec::native {

struct Update;

/// Of the vertex at position `at` of a chunk. `records`: those of all positions; those before `at`
/// are there. `listed_only`: no others than those of the update.
[[nodiscard]] KnownLights known_around(const Update& u, std::span<const std::uint32_t> positions,
                                       std::size_t at, const BlockTable& records, bool listed_only);

}  // namespace gicodec::native
